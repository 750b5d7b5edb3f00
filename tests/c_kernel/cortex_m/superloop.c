/* The counter of devices/counter.csp in a superloop, by its step interface: events come from a timer's interrupt, some of them while the loop is
 * busy. None may be lost but those that were reported as overwritten. */
#include "counter_api.h"
#include "csp_port.h"

#define TIMER_CONTROL (*(volatile uint32_t *)0x40000000U)
#define TIMER_VALUE (*(volatile uint32_t *)0x40000004U)
#define TIMER_RELOAD (*(volatile uint32_t *)0x40000008U)
#define TIMER_CLEAR (*(volatile uint32_t *)0x4000000CU)
#define SERIAL_DATA (*(volatile uint32_t *)0x40004000U)
#define SERIAL_CONTROL (*(volatile uint32_t *)0x40004008U)
#define SERIAL_DIVISOR (*(volatile uint32_t *)0x40004010U)
#define ENABLED_INTERRUPTS (*(volatile uint32_t *)0xE000E100U)

enum { OF_TIMER = 8, TIMER_RUNS = 9, SERIAL_SENDS = 1 };
enum { CYCLES = 2500 /* 100 us */, EVENTS = 500, BUSY = 1000000 /* ns */ };

static counter_memory memory;
static counter_instance *counter;
static volatile int pressed;
static volatile int overwritten;
static int taken;
static int released;

static void on_timer(void)
{
    TIMER_CLEAR = 1U;
    pressed++;
    overwritten += counter_press(counter, pressed) ? 1 : 0;
    if (pressed == EVENTS) {
        TIMER_CONTROL = 0U;
    }
}

extern void (*const interrupts[])(void);
void (*const interrupts[])(void) __attribute__((section(".vectors.devices"), used)) = {[OF_TIMER] = on_timer};

static void actuate(void *context, counter_output output, const counter_outputs *outputs, bool safe)
{
    (void)context;
    (void)output;
    (void)outputs;
    taken += safe ? 0 : 1;
    released += safe ? 1 : 0;
}

static uint32_t lock(void *context)
{
    (void)context;
    return csp_port_enter_critical();
}

static void unlock(void *context, uint32_t before)
{
    (void)context;
    csp_port_leave_critical(before);
}

static void wake(void *context)
{
    (void)context;
    csp_port_wake();
}

static void say(const char *word, int number)
{
    char digits[12];
    int at = (int)sizeof digits - 1;
    int rest = number;
    digits[at] = '\0';
    do {
        at--;
        digits[at] = (char)('0' + (rest % 10));
        rest /= 10;
    } while (rest > 0);
    for (const char *text = word; *text != '\0'; text++) {
        SERIAL_DATA = (uint32_t)*text;
    }
    for (const char *text = &digits[at]; *text != '\0'; text++) {
        SERIAL_DATA = (uint32_t)*text;
    }
    SERIAL_DATA = (uint32_t)'\n';
}

int main(void)
{
    static const counter_hooks hooks = {
        .real_time = true, .actuate = actuate, .lock = lock, .unlock = unlock, .wake = wake};
    counter_state state = COUNTER_MORE;
    int turns = 0;
    SERIAL_DIVISOR = 16U;
    SERIAL_CONTROL = SERIAL_SENDS;
    csp_port_start();
    counter = counter_begin(&memory, sizeof memory, &hooks, NULL);
    TIMER_RELOAD = (uint32_t)CYCLES;
    TIMER_VALUE = (uint32_t)CYCLES;
    TIMER_CONTROL = TIMER_RUNS;
    ENABLED_INTERRUPTS = 1U << OF_TIMER;
    while (counter_continues(state) && (pressed < EVENTS)) {
        state = counter_advance(counter, csp_port_now(), 8U);
        turns++;
        if ((turns % 20) == 0) {
            const int64_t began = csp_port_now();
            while ((csp_port_now() - began) < BUSY) {
                /* The rest of the loop. */
            }
        } else if (state == COUNTER_MORE) {
            csp_port_wait_until(counter_next(counter));
        } else {
            /* Something is still due. */
        }
    }
    (void)counter_advance(counter, csp_port_now(), 1000U);
    counter_stop(counter);
    state = counter_advance(counter, csp_port_now(), 1U);
    say("state ", (int)state);
    say("overwritten some ", (overwritten > 0) && (overwritten < EVENTS));
    say("lost ", EVENTS - taken - overwritten);
    say("released ", released);
    return 0;
}
