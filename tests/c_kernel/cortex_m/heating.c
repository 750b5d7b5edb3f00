/* The program of devices/heating.csp in a superloop, by its step interface. Its law fails as TROUBLE says; whatever that is, outputs get their safe
 * values, and the cause is reported. */
#include <math.h>
#include <string.h>

#include "csp_port.h"
#include "heater.h"
#include "heating_api.h"

#define SERIAL_DATA (*(volatile uint32_t *)0x40004000U)
#define SERIAL_CONTROL (*(volatile uint32_t *)0x40004008U)
#define SERIAL_DIVISOR (*(volatile uint32_t *)0x40004010U)

enum { SERIAL_SENDS = 1, NOWHERE = 0x60000000 };

static heating_memory memory;
static heating_instance *heating;

static void say(const char *text)
{
    for (const char *at = (text == NULL) ? "-" : text; *at != '\0'; at++) {
        SERIAL_DATA = (uint32_t)*at;
    }
    SERIAL_DATA = (uint32_t)'\n';
}

void heater_fails(struct heater *self)
{
    if (strcmp(TROUBLE, "bad pointer") == 0) {
        *(volatile uint32_t *)NOWHERE = 1U;
    } else if (strcmp(TROUBLE, "undefined instruction") == 0) {
        __asm__ volatile("udf #0");
    } else {
        self->power = NAN;
    }
}

void csp_port_release(void)
{
    char text[120];
    heating_release(heating);
    heating_describe(heating, text, sizeof text);
    say(text);
    say((csp_port_faulted_at() != 0U) ? "at an instruction" : "nowhere");
}

static bool sample(void *context, heating_input input, heating_inputs *inputs)
{
    (void)context;
    (void)input;
    inputs->level = 0.5;
    return true;
}

static void actuate(void *context, heating_output output, const heating_outputs *outputs, bool safe)
{
    (void)context;
    (void)outputs;
    if (safe) {
        say((output == HEATING_OUT_LAMP) ? "lamp is safe" : "power is safe");
    }
}

static void fault(void *context, const heating_instance *self)
{
    heating_failure failure;
    (void)context;
    say(heating_diagnose(self, &failure) ? "failed" : "not failed");
    say((failure.cause == HEATING_CAUSE_FAULT) ? "fault" : "other");
    say(failure.process);
    say(failure.law);
    say(failure.place);
}

int main(void)
{
    static const heating_hooks hooks = {.real_time = true, .sample = sample, .actuate = actuate, .fault = fault};
    heating_state state = HEATING_MORE;
    SERIAL_DIVISOR = 16U;
    SERIAL_CONTROL = SERIAL_SENDS;
    csp_port_start();
    heating = heating_begin(&memory, sizeof memory, &hooks, NULL);
    while (heating_continues(state)) {
        state = heating_advance(heating, csp_port_now(), 8U);
        csp_port_wait_until(heating_next(heating));
    }
    say("ended");
    return 0;
}
