/* Instances of devices/scaling.csp with parameters of their own: alone, interleaved, and restored after their parameters have changed. Prints the last
 * value of each drive. */
#include <stdio.h>

#include "scaling_api.h"

#define MS INT64_C(1000000)

typedef struct plant {
    double level;
    double drive;
} plant;

static bool sample(void *context, scaling_input input, scaling_inputs *inputs)
{
    (void)input;
    inputs->level = ((const plant *)context)->level;
    return true;
}

static void actuate(void *context, scaling_output output, const scaling_outputs *outputs, bool safe)
{
    (void)output;
    if (!safe) {
        ((plant *)context)->drive = outputs->drive;
    }
}

static scaling_instance *begin(scaling_memory *memory, plant *of, double gain)
{
    const scaling_parameters parameters = {.gain = gain};
    const scaling_hooks hooks = {.context = of, .parameters = &parameters, .sample = sample, .actuate = actuate};
    return scaling_begin(memory, sizeof *memory, &hooks, NULL);
}

static bool set(scaling_instance *self, double gain)
{
    const scaling_parameters parameters = {.gain = gain};
    return scaling_set(self, &parameters);
}

static double gain_of(const scaling_instance *self)
{
    scaling_parameters parameters;
    scaling_get(self, &parameters);
    return parameters.gain;
}

static void run(scaling_instance *self, int64_t from, int64_t to)
{
    for (int64_t now = from; now <= to; now++) {
        (void)scaling_advance(self, now * MS, 100U);
    }
}

static double alone(double gain, double level)
{
    static scaling_memory memory;
    plant of = {level, 0.0};
    run(begin(&memory, &of, gain), 0, 50);
    return of.drive;
}

int main(void)
{
    static scaling_memory memories[2];
    static scaling_memory copy;
    plant plants[2] = {{1.0, 0.0}, {10.0, 0.0}};
    scaling_instance *const one = begin(&memories[0], &plants[0], 3.0);
    scaling_instance *const other = begin(&memories[1], &plants[1], 0.5);
    for (int64_t now = 0; now <= 50; now++) {
        run(one, now, now);
        run(other, now, now);
    }
    (void)printf("alone %g %g, interleaved %g %g\n", alone(3.0, 1.0), alone(0.5, 10.0), plants[0].drive, plants[1].drive);
    (void)printf("set %d", set(one, 7.0));
    scaling_save(one, &copy);
    run(one, 51, 60);
    const double expected = plants[0].drive;
    (void)printf(", set again %d", set(one, 100.0));
    run(one, 61, 70);
    (void)printf(", gain %g, drive %g\n", gain_of(one), plants[0].drive);
    (void)printf("restored %d", scaling_restore(one, &copy));
    (void)printf(", gain %g", gain_of(one));
    run(one, 51, 60);
    (void)printf(", as before %d; the other has %g\n", plants[0].drive == expected, gain_of(other));
    plants[1].level = plants[0].level;
    (void)printf("in the other %d", scaling_restore(other, &copy));
    (void)printf(", gain %g", gain_of(other));
    run(other, 51, 60);
    (void)printf(", as before %d\n", plants[1].drive == expected);
    return 0;
}
