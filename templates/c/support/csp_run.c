/* A run: when time goes on, and what happens at an instant before any process runs.
 *
 * The environment advances; events are offered and samples taken, in the order of the ports; latched outputs are handed over; then
 * timers fall due.
 */
#include "csp_internal.h"
#include "csp_port.h"

/* Steps of processes between looks at the clock, and at requests to stop. In real time a process of a higher priority waits for one step of
 * the others, not for all of them that are ready. */
enum { STEPS_IN_REAL_TIME = (CSP_LEVELS > 1U) ? 1 : 64, STEPS_IN_VIRTUAL_TIME = 65536 };

static volatile bool stop_requested;
static int64_t next_grid; /* of the environment */
static int64_t next_tick; /* of a port or the grid */

/* Where the inputs and the latched outputs stand among the ports: from a number on, to before another. */
typedef struct range {
    uint32_t from;
    uint32_t to;
} range;

static range inputs;
static range outputs;
static uint32_t awaited; /* the port for which something waited last */

void csp_request_stop(void)
{
    stop_requested = true;
}

static int64_t earlier(int64_t one, int64_t other)
{
    return (one < other) ? one : other;
}

static int64_t later(int64_t one, int64_t other)
{
    return (one > other) ? one : other;
}

static void extend(range *ports, uint32_t index)
{
    if (ports->to == 0U) {
        ports->from = index;
    }
    ports->to = index + 1U;
}

/* Finds the ports that have instants, and the next instant of a tick or of the grid; INT64_MAX: none. */
static void begin_ticks(const csp_program *program)
{
    next_tick = next_grid;
    inputs.to = 0U;
    outputs.to = 0U;
    awaited = 0U;
    for (uint32_t index = 0U; index < program->port_count; index++) {
        if ((program->ports[index].kind == CSP_PORT_SAMPLED) || (program->ports[index].kind == CSP_PORT_EVENT)) {
            extend(&inputs, index);
        } else if (program->ports[index].kind == CSP_PORT_LATCHED) {
            extend(&outputs, index);
        } else {
            /* It has no instants. */
        }
    }
    for (uint32_t index = 0U; index < program->port_count; index++) {
        const csp_port *const port = &program->ports[index];
        if (port->kind == CSP_PORT_SAMPLED) {
            next_tick = earlier(next_tick, ((const csp_sampled_input *)(const void *)port->medium)->next);
        } else if (port->kind == CSP_PORT_LATCHED) {
            next_tick = earlier(next_tick, ((const csp_latched_output *)(const void *)port->medium)->next);
        } else {
            /* Events come on the grid, and direct outputs have no instants. */
        }
    }
}

static void inputs_meet(const csp_program *program, int64_t instant)
{
    for (uint32_t index = inputs.from; index < inputs.to; index++) {
        const csp_port *const port = &program->ports[index];
        if (port->kind == CSP_PORT_SAMPLED) {
            csp_sampled_input *const input = (csp_sampled_input *)(void *)port->medium;
            if (input->next == instant) {
                input->next += input->period;
                csp_sampled_tick(input);
            }
            next_tick = earlier(next_tick, input->next);
        } else if ((port->kind == CSP_PORT_EVENT) && (next_grid == instant)) {
            csp_event_poll((csp_event_input *)(void *)port->medium);
        } else {
            /* It has no instant now. */
        }
    }
}

static void outputs_meet(const csp_program *program, int64_t instant)
{
    for (uint32_t index = outputs.from; index < outputs.to; index++) {
        const csp_port *const port = &program->ports[index];
        if (port->kind == CSP_PORT_LATCHED) {
            csp_latched_output *const output = (csp_latched_output *)(void *)port->medium;
            if (output->next == instant) {
                output->next += output->period;
                csp_latched_tick(output);
            }
            next_tick = earlier(next_tick, output->next);
        }
    }
}

/* False: the environment has failed. */
static bool meet(const csp_program *program, int64_t instant)
{
    csp.now = instant;
    if (instant == next_tick) {
        if ((program->environment != NULL) && (program->environment->advance != NULL) &&
            !program->environment->advance(instant)) {
            return false;
        }
        next_tick = INT64_MAX;
        inputs_meet(program, instant);
        if (next_grid == instant) {
            next_grid += program->environment->step;
        }
        outputs_meet(program, instant);
        next_tick = earlier(next_tick, next_grid);
    }
    csp_timers_fall_due(instant);
    return true;
}

/* Whether the port can make a process ready, or will hand over a value. */
static bool port_can_come(const csp_port *port)
{
    switch (port->kind) {
    case CSP_PORT_SAMPLED:
        return csp_sampled_can_come((const csp_sampled_input *)(const void *)port->medium);
    case CSP_PORT_EVENT:
        return csp_event_can_come((const csp_event_input *)(const void *)port->medium);
    case CSP_PORT_LATCHED:
        return ((const csp_latched_output *)(const void *)port->medium)->written;
    default:
        return false;
    }
}

/* Whether anything can make a process ready or hand over a value later. */
static bool can_come(const csp_program *program)
{
    if (csp_timer_next() != INT64_MAX) {
        return true;
    }
    if ((awaited < program->port_count) && port_can_come(&program->ports[awaited])) {
        return true;
    }
    for (uint32_t index = 0U; index < program->port_count; index++) {
        if (port_can_come(&program->ports[index])) {
            awaited = index;
            return true;
        }
    }
    return false;
}

static csp_ending ended_by_itself(void)
{
    return (csp.error.exception == (uint16_t)CSP_NO_EXCEPTION) ? CSP_TERMINATED : CSP_FAILED;
}

static bool has_ended(const csp_program *program)
{
    return (program->process->party.flags & (unsigned)CSP_ENDED) != 0U;
}

static csp_ending environment_failed(void)
{
    csp.error.exception = (uint16_t)CSP_NO_EXCEPTION;
    return CSP_FAILED;
}

static csp_ending run_in_virtual_time(const csp_program *program, int64_t until)
{
    for (;;) {
        while (csp_run_ready(STEPS_IN_VIRTUAL_TIME)) {
            if (stop_requested) {
                return CSP_STOPPED;
            }
        }
        if (has_ended(program)) {
            return ended_by_itself();
        }
        if (stop_requested) {
            return CSP_STOPPED;
        }
        const int64_t timer = csp_timer_next();
        if ((timer == INT64_MAX) && !can_come(program)) {
            return CSP_DEADLOCK;
        }
        const int64_t instant = earlier(next_tick, timer);
        if ((until >= 0) && (instant > until)) {
            csp.now = until;
            return CSP_TIME_LIMIT;
        }
        if (!meet(program, instant)) {
            return environment_failed();
        }
    }
}

/* Events that interrupt handlers have brought occur now, which is before the next instant. */
static void take_over(const csp_program *program, int64_t next)
{
    const int64_t now = csp_port_now();
    csp.now = later(csp.now, earlier(now, next - 1));
    for (uint32_t index = 0U; index < program->port_count; index++) {
        if (program->ports[index].kind == CSP_PORT_EVENT) {
            csp_event_take_over((csp_event_input *)(void *)program->ports[index].medium);
        }
    }
}

static bool has_news(const csp_program *program)
{
    bool news = false;
    for (uint32_t index = 0U; (index < program->port_count) && !news; index++) {
        news = (program->ports[index].kind == CSP_PORT_EVENT) &&
               ((const csp_event_input *)(const void *)program->ports[index].medium)->news;
    }
    return news;
}

/* All instants that have passed are met before the next steps of processes, so that who computes too long finds its samples overwritten. */
static csp_ending run_in_real_time(const csp_program *program, int64_t until)
{
    for (;;) {
        bool ready = csp_run_ready(STEPS_IN_REAL_TIME);
        if (has_ended(program)) {
            return ended_by_itself();
        }
        if (!ready && !can_come(program)) {
            return CSP_DEADLOCK;
        }
        for (;;) {
            const int64_t due = earlier(next_tick, csp_timer_next());
            const int64_t instant = (until >= 0) ? earlier(due, until) : due;
            if (stop_requested) {
                return CSP_STOPPED;
            }
            if (!ready && !has_news(program)) {
                csp_port_wait_until(instant);
            }
            if (csp_port_now() < instant) {
                if (has_news(program)) {
                    take_over(program, instant);
                }
                break;
            }
            if (instant != due) {
                csp.now = until;
                return CSP_TIME_LIMIT;
            }
            csp_port_met(instant);
            if (!meet(program, instant)) {
                return environment_failed();
            }
            ready = true;
        }
    }
}

static void release(const csp_program *program)
{
    for (uint32_t index = 0U; index < program->port_count; index++) {
        const csp_port *const port = &program->ports[index];
        if (port->safe == NULL) {
            continue;
        }
        if (port->kind == CSP_PORT_LATCHED) {
            const csp_latched_output *const output = (const csp_latched_output *)(const void *)port->medium;
            if (output->driver.write != NULL) {
                output->driver.write(output->driver.device, port->safe);
            }
        } else {
            const csp_direct_output *const output = (const csp_direct_output *)(const void *)port->medium;
            if (output->driver.write != NULL) {
                output->driver.write(output->driver.device, port->safe);
            }
        }
        csp_observe_release(port->medium->number, port->safe);
    }
}

csp_ending csp_run(const csp_program *program, int64_t until)
{
    csp_ending ending = CSP_FAILED;
    csp_timers_reset();
    csp.now = 0;
    if ((program->environment != NULL) && (program->environment->start != NULL) && !program->environment->start()) {
        ending = environment_failed();
    } else {
        next_grid = INT64_MAX;
        if ((program->environment != NULL) && (program->environment->step > 0)) {
            next_grid = program->environment->step;
        }
        begin_ticks(program);
        program->process->party.flags = 0U;
        program->process->party.state = 0U;
        csp_ready(&program->process->party);
        csp_port_start();
        ending = csp_port_virtual_time ? run_in_virtual_time(program, until) : run_in_real_time(program, until);
    }
    release(program);
    csp_port_finish();
    return ending;
}
