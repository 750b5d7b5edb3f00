/* SPDX-License-Identifier: 0BSD */
/* A run in steps: what is due up to an instant, and how the run ends. It never waits; csp_run waits between the steps. */
#include "csp_internal.h"
#include "csp_shared.h"

void csp_build(csp_kernel *csp, const csp_program *program, const csp_hooks *hooks)
{
    (void)memset(csp, 0, sizeof *csp);
    csp->program = program;
    csp->hooks = hooks;
    csp->real_time = (hooks != NULL) && hooks->real_time;
    csp->phase = (uint8_t)CSP_BUILT;
}

uint32_t csp_lock(csp_kernel *csp)
{
    const csp_hooks *const hooks = csp->hooks;
    return ((hooks != NULL) && (hooks->lock != NULL)) ? hooks->lock(hooks->context) : 0U;
}

void csp_unlock(csp_kernel *csp, uint32_t outside)
{
    const csp_hooks *const hooks = csp->hooks;
    if ((hooks != NULL) && (hooks->unlock != NULL)) {
        hooks->unlock(hooks->context, outside);
    }
}

static void wake(csp_kernel *csp)
{
    const csp_hooks *const hooks = csp->hooks;
    if ((hooks != NULL) && (hooks->wake != NULL)) {
        hooks->wake(hooks->context);
    }
}

void csp_request_stop(csp_kernel *csp)
{
    if (csp != NULL) {
        CSP_STORE(csp->stop_requested, true);
        wake(csp);
    }
}

uint32_t csp_iterations(csp_kernel *csp)
{
    return (csp != NULL) ? CSP_LOAD(csp->iterations) : 0U;
}

static inline void begin_turn(csp_kernel *csp)
{
    const csp_hooks *const hooks = csp->hooks;
    CSP_NOTE(csp->iterations, csp->iterations + 1U);
    if ((hooks != NULL) && (hooks->alive != NULL)) {
        hooks->alive(hooks->context);
    }
}

static int64_t earlier(int64_t one, int64_t other)
{
    return (one < other) ? one : other;
}

static int64_t later(int64_t one, int64_t other)
{
    return (one > other) ? one : other;
}

/* Whether a port can make a process ready, or will write a value. With real devices, interrupt handlers may bring events. */
static bool port_can_come(csp_kernel *csp, const csp_port *port)
{
    (void)csp;
    switch (port->kind) {
#if CSP_USES_SAMPLED_INPUTS
    case CSP_PORT_SAMPLED:
        return csp_sampled_can_come((const csp_sampled_input *)(const void *)csp_medium_of(csp, port));
#endif
#if CSP_USES_EVENT_INPUTS
    case CSP_PORT_EVENT:
        return csp_event_can_come((const csp_event_input *)(const void *)csp_medium_of(csp, port),
                                  csp->program->environment == NULL);
#endif
#if CSP_USES_LATCHED_OUTPUTS
    case CSP_PORT_LATCHED:
        return ((const csp_latched_output *)(const void *)csp_medium_of(csp, port))->written;
#endif
    default:
        return false;
    }
}

/* Whether anything can make a process ready or write a value later. */
static bool can_come(csp_kernel *csp)
{
    if (csp_timer_next(csp) != INT64_MAX) {
        return true;
    }
    if ((csp->awaited < csp->program->port_count) && port_can_come(csp, &csp->program->ports[csp->awaited])) {
        return true;
    }
    for (uint32_t index = 0U; index < csp->program->port_count; index++) {
        if (port_can_come(csp, &csp->program->ports[index])) {
            csp->awaited = index;
            return true;
        }
    }
    return false;
}

/* ---- Ends ---- */

/* Whether the run continues. */
static bool runs(csp_kernel *csp)
{
    return (csp->phase == (uint8_t)CSP_RUNNING) && (csp->ending == (uint8_t)CSP_MORE);
}

static csp_ending end_with(csp_kernel *csp, csp_ending how)
{
    csp->ending = (uint8_t)how;
    return how;
}

static csp_ending ended_by_itself(csp_kernel *csp)
{
    return end_with(csp, (csp->error.exception == (uint16_t)CSP_NO_EXCEPTION) ? CSP_TERMINATED : CSP_FAILED);
}

static bool has_ended(csp_kernel *csp)
{
    return (csp_outermost(csp)->party.flags & (unsigned)CSP_ENDED) != 0U;
}

static csp_ending environment_failed(csp_kernel *csp)
{
    csp->error.exception = (uint16_t)CSP_NO_EXCEPTION;
    return end_with(csp, CSP_FAILED);
}

/* ---- Events that interrupt handlers have brought ---- */

void csp_announce_event(csp_kernel *csp)
{
    CSP_STORE(csp->news, true);
    wake(csp);
}

/* Makes these events occur, before the next instant. */
static void take_over(csp_kernel *csp, int64_t present)
{
    CSP_STORE(csp->news, false);
    csp->now = later(csp->now, earlier(present, csp_instants_next(csp) - 1));
    for (uint32_t index = 0U; index < csp->program->port_count; index++) {
        if ((CSP_USES_EVENT_INPUTS != 0) && (csp->program->ports[index].kind == CSP_PORT_EVENT)) {
            csp_event_take_over(csp, (csp_event_input *)(void *)csp_medium_of(csp, &csp->program->ports[index]));
        }
    }
}

/* ---- Instants ---- */

/* Executes an instant that is due. In virtual time it is the present one; against a clock everything up to `until` has passed. */
static inline bool meet(csp_kernel *csp, int64_t instant, int64_t until)
{
    if (!csp->real_time) {
        return csp_instants_meet(csp, instant, instant);
    }
    if (csp->hooks->met != NULL) {
        csp->hooks->met(csp->hooks->context, instant);
    }
    return csp_instants_meet(csp, instant, until);
}

/* Against a clock, everything that has happened since the last step comes before the next steps of processes, so a process that computes too long misses
 * samples. Returns whether the run continues. */
static bool catch_up(csp_kernel *csp, int64_t until)
{
    for (int64_t instant = csp_instants_next(csp); instant <= until; instant = csp_instants_next(csp)) {
        if (CSP_LOAD(csp->stop_requested)) {
            (void)end_with(csp, CSP_STOPPED);
            return false;
        }
        if (!meet(csp, instant, until)) {
            (void)environment_failed(csp);
            return false;
        }
    }
    if (CSP_LOAD(csp->news)) {
        take_over(csp, until);
    }
    return true;
}

/* ---- The interface ---- */

csp_ending csp_begin(csp_kernel *csp)
{
    const csp_environment *const environment = csp->program->environment;
    csp_process *const process = csp_outermost(csp);
    if (csp->phase != (uint8_t)CSP_BUILT) {
        return CSP_NOT_INITIALIZED;
    }
    csp->phase = (uint8_t)CSP_RUNNING;
    csp->ending = (uint8_t)CSP_MORE;
    csp_begin_driving(csp);
    if ((environment != NULL) && (environment->start != NULL) && !environment->start(csp, environment->state)) {
        return environment_failed(csp);
    }
    csp_instants_begin(csp);
    process->party.flags = 0U;
    process->party.state = 0U;
    csp_ready(csp, &process->party);
    return CSP_MORE;
}

static csp_ending advance(csp_kernel *csp, int64_t until, uint32_t steps)
{
    uint32_t left = steps;
    if (!runs(csp)) {
        return (csp->ending != (uint8_t)CSP_MORE) ? (csp_ending)csp->ending : CSP_NOT_INITIALIZED;
    }
    if ((until < csp->reached) || (until > CSP_END_OF_TIME)) {
        return CSP_REFUSED;
    }
    begin_turn(csp);
    if (csp->entered && csp->real_time && !catch_up(csp, until)) {
        return (csp_ending)csp->ending;
    }
    csp->entered = true;
    for (;;) {
        const bool ready = csp_run_ready(csp, &left);
        if (has_ended(csp)) {
            return ended_by_itself(csp);
        }
        if (CSP_LOAD(csp->stop_requested)) {
            return end_with(csp, CSP_STOPPED);
        }
        if (ready) {
            return CSP_BUDGET;
        }
        if (CSP_LOAD(csp->news)) {
            take_over(csp, csp->real_time ? until : csp->reached);
            continue;
        }
        if ((csp_timer_next(csp) == INT64_MAX) && !can_come(csp)) {
            return end_with(csp, CSP_DEADLOCK);
        }
        const int64_t instant = csp_instants_next(csp);
        if (instant > until) {
            csp->reached = until;
            return CSP_MORE;
        }
        csp_measure_leave(csp, true);
        csp_measure_enter(csp);
        if (!meet(csp, instant, until)) {
            return environment_failed(csp);
        }
        begin_turn(csp);
    }
}

csp_ending csp_advance(csp_kernel *csp, int64_t until, uint32_t steps)
{
    csp_measure_enter(csp);
    const csp_ending ending = advance(csp, until, steps);
    csp_measure_leave(csp, ending != CSP_BUDGET);
    return ending;
}

int64_t csp_next(csp_kernel *csp)
{
    if (!runs(csp)) {
        return INT64_MAX;
    }
    const bool at_once = csp_is_ready(csp) || CSP_LOAD(csp->news) || CSP_LOAD(csp->stop_requested);
    return at_once ? csp->reached : csp_instants_next(csp);
}

void csp_hand_over(csp_kernel *csp, int64_t instant)
{
    if (runs(csp) && (csp_next(csp) >= instant)) {
        csp_outputs_meet(csp, instant);
    }
}

void csp_finish(csp_kernel *csp)
{
    csp_release_outputs(csp);
    if (csp->phase == (uint8_t)CSP_RUNNING) {
        const csp_environment *const environment = csp->program->environment;
        if ((environment != NULL) && (environment->close != NULL)) {
            environment->close(environment->state);
        }
    }
    csp->phase = (uint8_t)CSP_FINISHED;
}
