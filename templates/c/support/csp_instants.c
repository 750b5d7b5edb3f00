/* What happens at an instant before any process runs.
 *
 * The environment advances; events are offered and samples taken, in the order of the ports; latched outputs are written; then
 * timers expire.
 */
#include "csp_internal.h"

/* How often event inputs are polled if the program has no periods. */
#define GRID_WITHOUT_PERIODS INT64_C(1000000)

static int64_t grid;      /* the period at which the environment is evaluated and event inputs are polled; 0: none */
static int64_t next_grid; /* INT64_MAX: none */
int64_t csp_next_tick;

/* A range of numbers of ports, without its end, that includes all inputs or all latched outputs. */
typedef struct range {
    uint32_t from;
    uint32_t to;
} range;

static range inputs;
static range outputs;

static int64_t earlier(int64_t one, int64_t other)
{
    return (one < other) ? one : other;
}

static void extend(range *ports, uint32_t index)
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
static int64_t period_of(const csp_port *port)
{
    switch (port->kind) {
    case CSP_PORT_SAMPLED:
        return ((const csp_sampled_input *)(const void *)port->medium)->period;
    case CSP_PORT_LATCHED:
        return ((const csp_latched_output *)(const void *)port->medium)->period;
    default:
        return 0;
    }
}

/* The next tick of a port that has a period. */
static int64_t tick_of(const csp_port *port)
{
    return (port->kind == CSP_PORT_SAMPLED) ? ((const csp_sampled_input *)(const void *)port->medium)->next
                                            : ((const csp_latched_output *)(const void *)port->medium)->next;
}

static bool is_polled(const csp_port *port)
{
    return (port->kind == CSP_PORT_EVENT) &&
           (((const csp_event_input *)(const void *)port->medium)->driver.read != NULL);
}

static int64_t common_divisor(int64_t one, int64_t other)
{
    int64_t greater = one;
    int64_t rest = other;
    while (rest != 0) {
        const int64_t next = greater % rest;
        greater = rest;
        rest = next;
    }
    return greater;
}

/* The step of the environment; without an environment, the greatest common divisor of the periods, at which devices are polled for events. */
static int64_t grid_of(const csp_program *program)
{
    int64_t divisor = 0;
    bool polled = false;
    if (program->environment != NULL) {
        return program->environment->step;
    }
    for (uint32_t index = 0U; index < program->port_count; index++) {
        polled = polled || is_polled(&program->ports[index]);
        divisor = common_divisor(divisor, period_of(&program->ports[index]));
    }
    if (!polled) {
        return 0;
    }
    return (divisor > 0) ? divisor : GRID_WITHOUT_PERIODS;
}

void csp_instants_begin(const csp_program *program)
{
    grid = grid_of(program);
    next_grid = (grid > 0) ? grid : INT64_MAX;
    csp_next_tick = next_grid;
    inputs.to = 0U;
    outputs.to = 0U;
    for (uint32_t index = 0U; index < program->port_count; index++) {
        const csp_port *const port = &program->ports[index];
        if ((port->kind == CSP_PORT_SAMPLED) || (port->kind == CSP_PORT_EVENT)) {
            extend(&inputs, index);
        } else if (port->kind == CSP_PORT_LATCHED) {
            extend(&outputs, index);
        } else {
            /* This port has no instants. */
        }
        if (period_of(port) > 0) {
            csp_next_tick = earlier(csp_next_tick, tick_of(port));
        }
    }
}

/* If several ticks have passed, only the last one reads the device: a late sample does not belong to the earlier instants. Returns the next tick of
 * an input; INT64_MAX: none. */
static int64_t inputs_meet(const csp_program *program, int64_t instant, int64_t present)
{
    int64_t next = INT64_MAX;
    for (uint32_t index = inputs.from; index < inputs.to; index++) {
        const csp_port *const port = &program->ports[index];
        if (port->kind == CSP_PORT_SAMPLED) {
            csp_sampled_input *const input = (csp_sampled_input *)(void *)port->medium;
            if (input->next == instant) {
                input->next = tick_after(instant, input->period);
                if (input->next > present) {
                    csp_sampled_tick(input);
                } else {
                    csp_sampled_skip(input);
                }
            }
            next = earlier(next, input->next);
        } else if ((port->kind == CSP_PORT_EVENT) && (next_grid == instant) && (tick_after(instant, grid) > present)) {
            csp_event_poll((csp_event_input *)(void *)port->medium);
        } else {
            /* This port has no instant now. */
        }
    }
    return next;
}

static int64_t outputs_meet(const csp_program *program, int64_t instant)
{
    int64_t next = INT64_MAX;
    for (uint32_t index = outputs.from; index < outputs.to; index++) {
        const csp_port *const port = &program->ports[index];
        if (port->kind == CSP_PORT_LATCHED) {
            csp_latched_output *const output = (csp_latched_output *)(void *)port->medium;
            if (output->next == instant) {
                output->next = tick_after(instant, output->period);
                csp_latched_tick(output);
            }
            next = earlier(next, output->next);
        }
    }
    return next;
}

bool csp_ticks_meet(const csp_program *program, int64_t instant, int64_t present)
{
    if ((program->environment != NULL) && (program->environment->advance != NULL) &&
        !program->environment->advance(instant)) {
        return false;
    }
    const int64_t next_input = inputs_meet(program, instant, present);
    if (next_grid == instant) {
        next_grid = tick_after(instant, grid);
    }
    const int64_t next_output = outputs_meet(program, instant);
    csp_next_tick = earlier(earlier(next_input, next_output), next_grid);
    return true;
}
