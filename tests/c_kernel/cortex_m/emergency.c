/* The spindle of models/emergency by its step interface: the buttons of its panel are interrupts of a timer, first start and then emergency. */
#include "csp_port.h"
#include "emergency_api.h"

#define TIMER_CONTROL (*(volatile uint32_t *)0x40000000U)
#define TIMER_VALUE (*(volatile uint32_t *)0x40000004U)
#define TIMER_RELOAD (*(volatile uint32_t *)0x40000008U)
#define TIMER_CLEAR (*(volatile uint32_t *)0x4000000CU)
#define SERIAL_DATA (*(volatile uint32_t *)0x40004000U)
#define SERIAL_CONTROL (*(volatile uint32_t *)0x40004008U)
#define SERIAL_DIVISOR (*(volatile uint32_t *)0x40004010U)
#define ENABLED_INTERRUPTS (*(volatile uint32_t *)0xE000E100U)

enum { OF_TIMER = 8, TIMER_RUNS = 9, SERIAL_SENDS = 1, CYCLES = 1250000 /* 50 ms */ };

static emergency_memory memory;
static emergency_instance *spindle;
static int presses;
static double speed;
static double voltage;
static bool brake;

static void write_line(const char *text)
{
    for (const char *at = text; *at != '\0'; at++) {
        SERIAL_DATA = (uint32_t)*at;
    }
    SERIAL_DATA = (uint32_t)'\n';
}

static void on_timer(void)
{
    TIMER_CLEAR = 1U;
    presses++;
    if (presses <= 2) {
        (void)emergency_panel(spindle, (presses == 1) ? EMERGENCY_BUTTON_START : EMERGENCY_BUTTON_EMERGENCY);
    } else {
        TIMER_CONTROL = 0U;
    }
}

extern void (*const interrupts[])(void);
void (*const interrupts[])(void) __attribute__((section(".vectors.devices"), used)) = {[OF_TIMER] = on_timer};

/* Called every 2 ms: the plant. */
static bool sample(void *context, emergency_input input, emergency_inputs *inputs)
{
    (void)context;
    (void)input;
    speed += (voltage - (brake ? speed : (0.05 * speed))) * 0.1;
    inputs->feedback = speed;
    return true;
}

static void actuate(void *context, emergency_output output, const emergency_outputs *outputs, bool safe)
{
    (void)context;
    if (output == EMERGENCY_OUT_CONTROL) {
        voltage = outputs->control;
    } else if (output == EMERGENCY_OUT_BRAKE) {
        brake = outputs->brake;
        write_line(safe ? "brake is safe" : (brake ? "brake on" : "brake off"));
    } else {
        write_line(outputs->halted ? "halted" : "not halted");
    }
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

int main(void)
{
    static const emergency_hooks hooks = {
        .real_time = true, .sample = sample, .actuate = actuate, .lock = lock, .unlock = unlock, .wake = wake};
    emergency_state state = EMERGENCY_MORE;
    char text[100];
    SERIAL_DIVISOR = 16U;
    SERIAL_CONTROL = SERIAL_SENDS;
    csp_port_start();
    spindle = emergency_begin(&memory, sizeof memory, &hooks, NULL);
    TIMER_RELOAD = (uint32_t)CYCLES;
    TIMER_VALUE = (uint32_t)CYCLES;
    TIMER_CONTROL = TIMER_RUNS;
    ENABLED_INTERRUPTS = 1U << OF_TIMER;
    while (emergency_continues(state)) {
        state = emergency_advance(spindle, csp_port_now(), 8U);
        if (state == EMERGENCY_MORE) {
            csp_port_wait_until(emergency_next(spindle));
        }
    }
    emergency_describe(spindle, text, sizeof text);
    write_line(text);
    return 0;
}
