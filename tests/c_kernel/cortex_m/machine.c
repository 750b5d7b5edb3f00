/* The machine of devices/machine.csp on the emulated board: its button is a real interrupt, that of a timer, and it prints to its serial
 * line. TROUBLE says what goes wrong. */
#include <assert.h>
#include <stdlib.h>

#include "csp_external.h"
#include "csp_port.h"
#include "network.h"

#define TIMER_CONTROL (*(volatile uint32_t *)0x40000000U)
#define TIMER_VALUE (*(volatile uint32_t *)0x40000004U)
#define TIMER_RELOAD (*(volatile uint32_t *)0x40000008U)
#define TIMER_CLEAR (*(volatile uint32_t *)0x4000000CU)
#define SERIAL_DATA (*(volatile uint32_t *)0x40004000U)
#define SERIAL_CONTROL (*(volatile uint32_t *)0x40004008U)
#define SERIAL_DIVISOR (*(volatile uint32_t *)0x40004010U)
#define WATCHDOG_CYCLES (*(volatile uint32_t *)0x40008000U)
#define WATCHDOG_CONTROL (*(volatile uint32_t *)0x40008008U)
#define WATCHDOG_RELOAD (*(volatile uint32_t *)0x4000800CU)
#define ENABLED_INTERRUPTS (*(volatile uint32_t *)0xE000E100U)

enum { WARNS_AND_RESETS = 3 }; /* an NMI, and when the time has passed again a reset */
enum { OF_TIMER = 8, TIMER_RUNS = 9, CYCLES = 25000 * 21, SERIAL_SENDS = 1, SERIAL_INTERRUPTS = 4, OF_SERIAL = 1, NOWHERE = 0x60000000 };

static struct network network;
static int polled;
static int sampled;
static int turns;

static bool is(const char *name)
{
    return strcmp(TROUBLE, name) == 0;
}

/* Whether the name is part of it. */
static bool has(const char *name)
{
    return strstr(TROUBLE, name) != NULL;
}

static void write_text(const char *text)
{
    SERIAL_DIVISOR = 16U;
    SERIAL_CONTROL = SERIAL_SENDS;
    for (const char *at = text; *at != '\0'; at++) {
        SERIAL_DATA = (uint32_t)*at;
    }
}

static void say(const char *word, int number)
{
    char text[2] = {(char)('0' + (number % 10)), '\0'};
    write_text(word);
    if (number > 9) {
        char tens[2] = {(char)('0' + (number / 10 % 10)), '\0'};
        write_text(tens);
    }
    write_text(text);
    write_text("\n");
}

static void fault(void)
{
    *(volatile uint32_t *)NOWHERE = 1U;
}

static int overflow(int depth)
{
    volatile char frame[256];
    frame[0] = (char)depth;
    return (depth < 0) ? frame[0] : (overflow(depth + 1) + frame[0]);
}

static void on_timer(void)
{
    TIMER_CLEAR = 1U;
    TIMER_CONTROL = 0U;
    if (has("fault in an interrupt")) {
        fault();
    } else if (is("exit in an interrupt")) {
        exit(0);
    } else {
        /* It is the button. */
    }
    (void)network_bring_button(&network, true);
}

extern void (*const interrupts[])(void);
void (*const interrupts[])(void) __attribute__((section(".vectors.devices"), used)) = {[OF_TIMER] = on_timer};

void csp_port_alive(void)
{
    WATCHDOG_RELOAD = 1U;
    turns++;
}

static bool read_button(void *device, void *value)
{
    (void)device;
    polled++;
    *(bool *)value = true;
    return polled == 10;
}

static bool read_level(void *device, void *value)
{
    (void)device;
    sampled++;
    *(double *)value = 3.0;
    if (sampled == 5) {
        if (is("fault") || is("fault in a safe value")) {
            fault();
        } else if (is("undefined instruction")) {
            __asm__ volatile("udf #0");
        } else if (has("read overflows")) {
            say("deep ", overflow(0));
        } else if (has("read exits")) {
            exit(0);
        } else if (is("read aborts")) {
            abort();
        } else if (is("read asserts")) {
            assert(sampled < 5);
        } else if (has("read hangs")) {
            for (;;) {
            }
        } else if (is("interrupt without a handler")) {
            SERIAL_CONTROL = SERIAL_SENDS | SERIAL_INTERRUPTS; /* stays until it is acknowledged */
            ENABLED_INTERRUPTS = 1U << OF_SERIAL;
            SERIAL_DATA = (uint32_t)'\n';
        } else if (is("unexpected interrupt")) {
            *(volatile uint32_t *)0xE000ED04U = 1U << 28U; /* PendSV */
        } else {
            /* It continues. */
        }
    }
    if (is("slow")) {
        const int64_t began = csp_port_now();
        while (csp_port_now() - began < 3000000) {
        }
    }
    return true;
}

/* Needs as much of the stack as an output may. */
static void write_large(void)
{
    volatile char frame[2048];
    for (size_t at = 0U; at < sizeof frame; at++) {
        frame[at] = (char)-1;
    }
}

static void write_drive(void *device, const void *value)
{
    (void)device;
    if (*(const double *)value < 0.0) {
        write_text("released drive\n");
        if (is("fault in a safe value")) {
            fault();
        } else if (has("safe value is large")) {
            write_large();
        } else if (has("safe value overflows")) {
            say("deep ", overflow(0));
        } else if (has("safe value hangs")) {
            for (;;) {
            }
        } else if (has("safe value exits")) {
            exit(0);
        } else {
            /* It is safe. */
        }
    }
}

static void write_lamp(void *device, const void *value)
{
    (void)device;
    write_text(*(const bool *)value ? "lamp\n" : "released lamp\n");
}

static uint32_t masked(void)
{
    uint32_t mask = 0U;
    __asm__ volatile("mrs %0, primask" : "=r"(mask));
    return mask;
}

static void look_at_critical_sections(void)
{
    const uint32_t outer = csp_port_enter_critical();
    const uint32_t inner = csp_port_enter_critical();
    csp_port_leave_critical(inner);
    say("masked in between ", (int)masked());
    csp_port_leave_critical(outer);
    say("masked after ", (int)masked());
}

static void run(void)
{
    const struct network_drivers drivers = {
        .button = {.read = (has("polled") || is("twice")) ? read_button : NULL},
        .level = {.read = read_level},
        .drive = {.write = write_drive},
        .lamp = {.write = write_lamp},
    };
    char text[100] = "";
    polled = 0;
    sampled = 0;
    network_initialize(&network, &drivers, csp_port_hooks());
    TIMER_RELOAD = (uint32_t)CYCLES;
    TIMER_VALUE = (uint32_t)CYCLES;
    TIMER_CONTROL = TIMER_RUNS;
    const csp_ending ending = csp_run(&network.kernel, INT64_C(1000000000));
    say("sampled ", sampled);
    say("ending ", (int)ending);
    if (ending == CSP_FAILED) {
        csp_describe_error(&network.kernel, text, sizeof text);
        write_text(text);
        write_text("\n");
    }
}

int main(void)
{
    if (has("watchdog")) {
        WATCHDOG_CYCLES = CYCLES;
        WATCHDOG_CONTROL = WARNS_AND_RESETS;
    }
    look_at_critical_sections();
    if (strncmp(TROUBLE, "pressed", 7U) == 0 || has("in an interrupt")) {
        ENABLED_INTERRUPTS = 1U << OF_TIMER;
    }
    run();
    if (is("twice")) {
        run();
    }
    say("alive ", turns > 5);
    write_text("end\n");
    return 0;
}
