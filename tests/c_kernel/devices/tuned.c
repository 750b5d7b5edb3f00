/* Parameters of tuned.csp that are refused, and why. */
#include <math.h>
#include <stdio.h>

#include "tuned_api.h"

static tuned_memory memory;
static double driven;

static bool sample(void *context, tuned_input input, tuned_inputs *inputs)
{
    (void)context;
    (void)input;
    inputs->x = 1.0;
    return true;
}

static void actuate(void *context, tuned_output output, const tuned_outputs *outputs, bool safe)
{
    (void)context;
    (void)output;
    driven = safe ? driven : outputs->y;
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

static void set(tuned_instance *self, const tuned_parameters *parameters)
{
    tuned_parameter parameter = TUNED_PARAMETER_GAINS;
    const bool done = tuned_set(self, parameters);
    const tuned_refusal refusal = tuned_why_refused(self, &parameter);
    (void)printf("done %d, refusal %d, parameter %d", done, (int)refusal, (int)parameter);
}

int main(void)
{
    const tuned_hooks hooks = {.sample = sample, .actuate = actuate, .lock = lock, .unlock = unlock};
    tuned_instance *const self = tuned_begin(&memory, sizeof memory, &hooks, NULL);
    int64_t now = 0;
    for (int which = 0; which < 4; which++) {
        tuned_parameters parameters;
        tuned_get(self, &parameters);
        if (which == 0) {
            parameters.gains.kp = 3.0;
        } else if (which == 1) {
            parameters.gains.kp = (double)INFINITY;
        } else {
            parameters.count = (which == 2) ? 0 : 5;
        }
        set(self, &parameters);
        now += 2000000;
        (void)tuned_advance(self, now, 1000U);
        (void)printf("; driven %g\n", driven);
    }
    return 0;
}
