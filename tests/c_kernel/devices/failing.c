/* The two ends of failing.csp, and what the hook finds before the outputs are released. */
#include <stdio.h>

#include "failing_api.h"

static failing_memory memory;
static int released;

static void actuate(void *context, failing_output output, const failing_outputs *outputs, bool safe)
{
    (void)context;
    (void)output;
    (void)outputs;
    released += safe ? 1 : 0;
}

static uint32_t lock(void *context)
{
    (void)context;
    return 0U;
}

static void unlock(void *context, uint32_t before)
{
    (void)context;
    (void)before;
}

static void report(void *context, const failing_instance *self)
{
    failing_failure failure;
    (void)context;
    (void)printf("failed %d", failing_diagnose(self, &failure));
    (void)printf(", cause %d at %lld ns in %s, %s, exception %s; released %d\n", (int)failure.cause, (long long)failure.instant,
                 (failure.process != NULL) ? failure.process : "none", (failure.place != NULL) ? failure.place : "nowhere",
                 (failure.exception != NULL) ? failure.exception : "none", released);
}

int main(void)
{
    const failing_hooks hooks = {.actuate = actuate, .lock = lock, .unlock = unlock, .fault = report};
    for (int64_t how = 1; how <= 2; how++) {
        failing_instance *const self = failing_begin(&memory, sizeof memory, &hooks, NULL);
        released = 0;
        (void)failing_button(self, how);
        const failing_state state = failing_advance(self, 5, 1000U);
        (void)printf("state %d, released %d\n", (int)state, released);
    }
    return 0;
}
