/* SPDX-License-Identifier: 0BSD */
/* What happens at an instant before any process runs.
 *
 * The environment advances; events are offered and samples taken, in the order of the ports; latched outputs are written; then
 * timers expire.
 */
#include "csp_internal.h"

static int64_t earlier(int64_t one, int64_t other)
{
    return (one < other) ? one : other;
}

static void extend(csp_range *ports, uint32_t index)
{
    if (ports->to == 0U) {
        ports->from = index;
    }
    ports->to = index + 1U;
}

/* The next tick after `tick`; INT64_MAX: none. */
static int64_t tick_after(int64_t tick, int64_t period)
{
    return (period <= (INT64_MAX - tick)) ? (tick + period) : INT64_MAX;
}

/* The period of a port; 0: none. */
static int64_t period_of(csp_kernel *csp, const csp_port *port)
{
    (void)csp;
    switch (port->kind) {
#if CSP_USES_SAMPLED_INPUTS
    case CSP_PORT_SAMPLED:
        return ((const csp_sampled_input *)(const void *)csp_medium_of(csp, port))->period;
#endif
#if CSP_USES_LATCHED_OUTPUTS
    case CSP_PORT_LATCHED:
        return ((const csp_latched_output *)(const void *)csp_medium_of(csp, port))->period;
#endif
    default:
        return 0;
    }
}

/* The next tick of a port that has a period. */
static int64_t tick_of(csp_kernel *csp, const csp_port *port)
{
    return (port->kind == CSP_PORT_SAMPLED) ? ((const csp_sampled_input *)(const void *)csp_medium_of(csp, port))->next
                                            : ((const csp_latched_output *)(const void *)csp_medium_of(csp, port))->next;
}

static bool is_polled(csp_kernel *csp, const csp_port *port)
{
    return (CSP_USES_EVENT_INPUTS != 0) && (port->kind == CSP_PORT_EVENT) &&
           (((const csp_event_input *)(const void *)csp_medium_of(csp, port))->driver.read != NULL);
}

/* The step of the environment; without an environment, how often devices are polled for events. */
static int64_t grid_of(csp_kernel *csp)
{
    const csp_program *const program = csp->program;
    bool polled = false;
    if (program->environment != NULL) {
        return program->environment->step;
    }
    for (uint32_t index = 0U; (CSP_USES_EVENT_INPUTS != 0) && (index < program->port_count); index++) {
        polled = polled || is_polled(csp, &program->ports[index]);
    }
    if (!polled) {
        return 0;
    }
    return ((csp->hooks != NULL) && (csp->hooks->grid > 0)) ? csp->hooks->grid : program->grid;
}

void csp_instants_begin(csp_kernel *csp)
{
    csp->grid = grid_of(csp);
    csp->next_grid = (csp->grid > 0) ? csp->grid : INT64_MAX;
    csp->next_tick = csp->next_grid;
    csp->inputs.to = 0U;
    csp->outputs.to = 0U;
    for (uint32_t index = 0U; index < csp->program->port_count; index++) {
        const csp_port *const port = &csp->program->ports[index];
        if ((CSP_USES_INPUTS != 0) && ((port->kind == CSP_PORT_SAMPLED) || (port->kind == CSP_PORT_EVENT))) {
            extend(&csp->inputs, index);
        } else if ((CSP_USES_LATCHED_OUTPUTS != 0) && (port->kind == CSP_PORT_LATCHED)) {
            extend(&csp->outputs, index);
        } else {
            /* This port has no instants. */
        }
        if (period_of(csp, port) > 0) {
            csp->next_tick = earlier(csp->next_tick, tick_of(csp, port));
        }
    }
}

/* The last tick that has passed, and how many there were after `instant`. By doubling, because a division and a multiplication of 64 bits take flash on small
 * processors. */
static int64_t last_passed(int64_t instant, int64_t period, int64_t present, int64_t *count)
{
    int64_t rest = present - instant;
    int64_t part = period;
    int64_t periods = 1;
    while (part <= (rest - part)) {
        part *= 2;
        periods *= 2;
    }
    while (periods > 0) {
        if (part <= rest) {
            rest -= part;
            *count += periods;
        }
        part /= 2;
        periods /= 2;
    }
    return present - rest;
}

/* The tick to be executed after one, `instant`, where another one has passed already. Counts the ticks from this one to that one. Without an environment it is
 * the last that has: nothing happens at those between, so the work does not grow with the lateness. */
static CSP_COLD int64_t late_tick(const csp_kernel *csp, int64_t instant, int64_t period, int64_t present, int64_t *count)
{
    if (csp->program->environment == NULL) {
        return last_passed(instant, period, present, count);
    }
    *count = 1;
    return instant + period;
}

static inline uint32_t alike(const csp_port *port)
{
    return (CSP_USES_ALIKE_PORTS != 0) ? port->alike : 0U;
}

/* If several ticks have passed, only the last one reads the device: a late sample does not belong to the earlier instants. Returns the next tick of these
 * inputs, which are alike. */
static int64_t sample_inputs(csp_kernel *csp, const csp_port *first, int64_t instant, int64_t present)
{
    const int64_t period = ((const csp_sampled_input *)(const void *)csp_medium_of(csp, first))->period;
    int64_t next = tick_after(instant, period);
    int64_t passed = 0;
    if (next <= present) {
        next = late_tick(csp, instant, period, present, &passed);
    }
    for (uint32_t index = 0U; index <= alike(first); index++) {
        csp_sampled_input *const input = (csp_sampled_input *)(void *)csp_medium_of(csp, &first[index]);
        input->next = next;
        if (passed == 0) {
            csp_sampled_tick(csp, input);
        } else {
            csp_sampled_skip(input, passed);
        }
    }
    return next;
}

/* Returns the next tick of an input; INT64_MAX: none. */
static int64_t inputs_meet(csp_kernel *csp, int64_t instant, int64_t present)
{
    const csp_port *const ports = csp->program->ports;
    const uint32_t end = (CSP_USES_INPUTS != 0) ? csp->inputs.to : 0U;
    int64_t next = INT64_MAX;
    for (uint32_t index = csp->inputs.from; index < end; index += 1U + alike(&ports[index])) {
        const csp_port *const port = &ports[index];
        if ((CSP_USES_SAMPLED_INPUTS != 0) && (port->kind == CSP_PORT_SAMPLED)) {
            const int64_t tick = ((const csp_sampled_input *)(const void *)csp_medium_of(csp, port))->next;
            next = earlier(next, (tick == instant) ? sample_inputs(csp, port, instant, present) : tick);
        } else if ((CSP_USES_EVENT_INPUTS != 0) && (port->kind == CSP_PORT_EVENT) && (csp->next_grid == instant) &&
                   (tick_after(instant, csp->grid) > present)) {
            csp_event_poll(csp, (csp_event_input *)(void *)csp_medium_of(csp, port));
        } else {
            /* This port has no instant now. */
        }
    }
    return next;
}

/* Hands over these outputs, which are alike. Returns their next tick. */
static int64_t hand_over(csp_kernel *csp, const csp_port *first, int64_t instant, int64_t present)
{
    const int64_t period = ((const csp_latched_output *)(const void *)csp_medium_of(csp, first))->period;
    int64_t next = tick_after(instant, period);
    int64_t passed = 0;
    if (next <= present) {
        next = late_tick(csp, instant, period, present, &passed);
    }
    for (uint32_t index = 0U; index <= alike(first); index++) {
        csp_latched_output *const output = (csp_latched_output *)(void *)csp_medium_of(csp, &first[index]);
        output->next = next;
        csp_latched_tick(csp, output);
    }
    return next;
}

/* Returns the next tick of an output; INT64_MAX: none. */
static inline int64_t outputs_meet(csp_kernel *csp, int64_t instant, int64_t present)
{
    const csp_port *const ports = csp->program->ports;
    const uint32_t end = (CSP_USES_LATCHED_OUTPUTS != 0) ? csp->outputs.to : 0U;
    int64_t next = INT64_MAX;
    for (uint32_t index = csp->outputs.from; index < end; index += 1U + alike(&ports[index])) {
        const csp_port *const port = &ports[index];
        if ((CSP_USES_LATCHED_OUTPUTS != 0) && (port->kind == CSP_PORT_LATCHED)) {
            const int64_t tick = ((const csp_latched_output *)(const void *)csp_medium_of(csp, port))->next;
            next = earlier(next, (tick == instant) ? hand_over(csp, port, instant, present) : tick);
        }
    }
    return next;
}

void csp_outputs_meet(csp_kernel *csp, int64_t instant)
{
    (void)outputs_meet(csp, instant, instant);
}

bool csp_ticks_meet(csp_kernel *csp, int64_t instant, int64_t present)
{
    const csp_environment *const environment = csp->program->environment;
    if ((environment != NULL) && (environment->advance != NULL) && !environment->advance(csp, environment->state, instant)) {
        return false;
    }
    const int64_t next_input = inputs_meet(csp, instant, present);
    if (csp->next_grid == instant) {
        int64_t passed = 0;
        csp->next_grid = tick_after(instant, csp->grid);
        if ((CSP_USES_EVENT_INPUTS != 0) && (csp->next_grid <= present)) {
            csp->next_grid = late_tick(csp, instant, csp->grid, present, &passed);
        }
    }
    const int64_t next_output = outputs_meet(csp, instant, present);
    csp->next_tick = earlier(earlier(next_input, next_output), csp->next_grid);
    return true;
}
