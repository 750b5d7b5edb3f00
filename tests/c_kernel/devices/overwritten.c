/* Damaged memory in overwritten.csp: `./program PROCESS STATE MS` overwrites the state of a process of the composition at an instant. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "csp_config.h"
#include "network.h"
#include "overwritten_api.h"

static overwritten_memory memory;
static double driven;
static int released;
static int after;

static bool sample(void *context, overwritten_input input, overwritten_inputs *inputs)
{
    (void)context;
    (void)input;
    inputs->level = 0.5;
    return true;
}

static void actuate(void *context, overwritten_output output, const overwritten_outputs *outputs, bool safe)
{
    (void)context;
    (void)output;
    driven = outputs->opening;
    released += safe ? 1 : 0;
    after += ((released > 0) && !safe) ? 1 : 0;
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

int main(int count, char **arguments)
{
    const overwritten_hooks hooks = {.sample = sample, .actuate = actuate, .lock = lock, .unlock = unlock};
    overwritten_instance *const self = overwritten_begin(&memory, sizeof memory, &hooks, NULL);
    struct network network;
    overwritten_state state = OVERWRITTEN_MORE;
    char text[200];
    int64_t now = 0;
    if (count < 4) {
        return 1;
    }
    for (; (now < 400) && (state == OVERWRITTEN_MORE); now += 5) {
        if (now == atoi(arguments[3])) {
            (void)memcpy(&network, self, sizeof network); /* an instance begins with its network */
            csp_process *const process = (strcmp(arguments[1], "branch") == 0) ? &network.top.read_level_branch
                                                                              : &network.top.process;
            process->party.state = (uint16_t)atoi(arguments[2]);
            (void)memcpy(&memory, &network, sizeof network);
        }
        state = overwritten_advance(self, now * INT64_C(1000000), 1000U);
    }
    overwritten_failure failure;
    (void)overwritten_diagnose(self, &failure);
    overwritten_describe(self, text, sizeof text);
    (void)printf("%d at %d ms: %s; %s; driven %g, released %d, after that %d\n", (int)state, (int)now - 5, text,
        (failure.place != NULL) ? failure.place : "nowhere", driven, released, after);
    return 0;
}
