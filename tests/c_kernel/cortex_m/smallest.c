/* The smallest main of a firmware: a superloop around the program, whose devices are registers. */
#include API_HEADER

#include <string.h>

#include "csp_port.h"

#define JOINED(name, word) name##word
#define OF(name, word) JOINED(name, word)
#define API(word) OF(PACKAGE, word)

static API(_memory) memory;

static volatile uint32_t registers[16];

#ifdef HAS_SAMPLE
static bool sample(void *context, API(_input) input, API(_inputs) *inputs)
{
    const uint32_t value = registers[input];
    (void)context;
    (void)memcpy(inputs, &value, sizeof value);
    return true;
}
#endif

#ifdef HAS_ACTUATE
static void actuate(void *context, API(_output) output, const API(_outputs) *outputs, bool safe)
{
    uint32_t value = 0;
    (void)context;
    (void)memcpy(&value, outputs, sizeof value);
    registers[output] = safe ? 0 : value;
}
#endif

#ifdef HAS_LOCK
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

#endif
int main(void)
{
    static const API(_hooks) hooks = {
        .real_time = true,
#ifdef HAS_SAMPLE
        .sample = sample,
#endif
#ifdef HAS_ACTUATE
        .actuate = actuate,
#endif
#ifdef HAS_LOCK
        .lock = lock,
        .unlock = unlock,
#endif
    };
    csp_port_start();
    API(_instance) *const self = API(_begin)(&memory, sizeof memory, &hooks, NULL);
    while (API(_continues)(API(_advance)(self, csp_port_now(), 64U))) {
        csp_port_wait_until(API(_next)(self));
    }
#ifdef DESCRIBES
    char text[120];
    API(_describe)(self, text, sizeof text);
    csp_port_write(text);
#endif
    return 0;
}
