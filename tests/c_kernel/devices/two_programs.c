/* devices/machine.csp and devices/counter.csp in one program: what the one drives is not what the other counts. */
#include <stdio.h>

#include "counter_api.h"
#include "machine_api.h"

static machine_memory of_machine;
static counter_memory of_counter;
static int driven;
static int taken;

static bool sample(void *context, machine_input input, machine_inputs *inputs)
{
    (void)context;
    (void)input;
    inputs->level = 1.0;
    return true;
}

static void drive(void *context, machine_output output, const machine_outputs *outputs, bool safe)
{
    (void)context;
    (void)outputs;
    driven += (!safe && (output == MACHINE_OUT_DRIVE)) ? 1 : 0;
}

static void take(void *context, counter_output output, const counter_outputs *outputs, bool safe)
{
    (void)context;
    (void)output;
    taken += ((outputs->taken == 7) && !safe) ? 1 : 0;
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

int main(void)
{
    const machine_hooks hooks_of_machine = {.sample = sample, .actuate = drive, .lock = lock, .unlock = unlock};
    const counter_hooks hooks_of_counter = {.actuate = take, .lock = lock, .unlock = unlock};
    machine_instance *const machine = machine_begin(&of_machine, sizeof of_machine, &hooks_of_machine, NULL);
    counter_instance *const counter = counter_begin(&of_counter, sizeof of_counter, &hooks_of_counter, NULL);
    (void)counter_press(counter, 7);
    (void)machine_advance(machine, 10000000, 100U);
    (void)counter_advance(counter, 10000000, 100U);
    (void)machine_button(machine, true);
    (void)printf("machine %d, driven %d\n", (int)machine_advance(machine, 10000000, 100U), driven);
    (void)printf("counter %d, taken %d\n", (int)counter_advance(counter, 10000000, 100U), taken);
    return 0;
}
