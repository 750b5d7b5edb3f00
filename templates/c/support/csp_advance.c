/* A run in steps: what is due up to an instant, and how the run ends. It never waits; csp_run waits between the steps. */
#include "csp_arithmetic.h"
#include "csp_internal.h"
#include "csp_port.h"
#include "csp_shared.h"

static const csp_program *running; /* between csp_begin and csp_finish; NULL: none */
static csp_ending ending;          /* CSP_MORE, or how the run has ended */
static int64_t reached;            /* the instant up to which the run has advanced */
static bool entered;               /* csp_advance has been called */
static bool built;
static volatile bool stop_requested;
static volatile bool news; /* an interrupt handler has brought an event since the last were taken over */
static volatile uint32_t iterations;
static uint32_t awaited; /* the port for which something waited last */

void csp_begin_building(void)
{
    (void)memset(&csp, 0, sizeof csp);
    csp_fault.describe = NULL;
    csp_timers_reset();
    CSP_STORE(stop_requested, false);
    CSP_STORE(news, false);
    awaited = 0U;
    built = true;
}

void csp_request_stop(void)
{
    CSP_STORE(stop_requested, true);
    csp_port_wake();
}

uint32_t csp_iterations(void)
{
    return CSP_LOAD(iterations);
}

static void begin_turn(void)
{
    CSP_NOTE(iterations, iterations + 1U);
    csp_port_alive();
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
static bool port_can_come(const csp_program *program, const csp_port *port)
{
    switch (port->kind) {
    case CSP_PORT_SAMPLED:
        return csp_sampled_can_come((const csp_sampled_input *)(const void *)port->medium);
    case CSP_PORT_EVENT:
        return csp_event_can_come((const csp_event_input *)(const void *)port->medium,
                                  !csp_port_virtual_time && (program->environment == NULL));
    case CSP_PORT_LATCHED:
        return ((const csp_latched_output *)(const void *)port->medium)->written;
    default:
        return false;
    }
}

/* Whether anything can make a process ready or write a value later. */
static bool can_come(const csp_program *program)
{
    if (csp_timer_next() != INT64_MAX) {
        return true;
    }
    if ((awaited < program->port_count) && port_can_come(program, &program->ports[awaited])) {
        return true;
    }
    for (uint32_t index = 0U; index < program->port_count; index++) {
        if (port_can_come(program, &program->ports[index])) {
            awaited = index;
            return true;
        }
    }
    return false;
}

/* ---- Ends ---- */

static csp_ending end_with(csp_ending how)
{
    ending = how;
    return how;
}

static csp_ending ended_by_itself(void)
{
    return end_with((csp.error.exception == (uint16_t)CSP_NO_EXCEPTION) ? CSP_TERMINATED : CSP_FAILED);
}

static bool has_ended(void)
{
    return (running->process->party.flags & (unsigned)CSP_ENDED) != 0U;
}

static csp_ending environment_failed(void)
{
    csp.error.exception = (uint16_t)CSP_NO_EXCEPTION;
    return end_with(CSP_FAILED);
}

/* ---- Events that interrupt handlers have brought ---- */

void csp_announce_event(void)
{
    CSP_STORE(news, true);
    csp_port_wake();
}

/* Makes these events occur, before the next instant. */
static void take_over(int64_t present)
{
    CSP_STORE(news, false);
    csp.now = later(csp.now, earlier(present, csp_instants_next() - 1));
    for (uint32_t index = 0U; index < running->port_count; index++) {
        if (running->ports[index].kind == CSP_PORT_EVENT) {
            csp_event_take_over((csp_event_input *)(void *)running->ports[index].medium);
        }
    }
}

/* ---- Instants ---- */

/* Executes an instant that is due. In virtual time it is the present one; against a clock everything up to `until` has passed. */
static inline bool meet(int64_t instant, int64_t until)
{
    if (csp_port_virtual_time) {
        return csp_instants_meet(running, instant, instant);
    }
    csp_port_met(instant);
    return csp_instants_meet(running, instant, until);
}

/* Against a clock, everything that has happened since the last step comes before the next steps of processes, so a process that computes too long misses
 * samples. Returns whether the run continues. */
static bool catch_up(int64_t until)
{
    for (int64_t instant = csp_instants_next(); instant <= until; instant = csp_instants_next()) {
        if (CSP_LOAD(stop_requested)) {
            (void)end_with(CSP_STOPPED);
            return false;
        }
        if (!meet(instant, until)) {
            (void)environment_failed();
            return false;
        }
    }
    if (CSP_LOAD(news)) {
        take_over(until);
    }
    return true;
}

/* ---- The interface ---- */

csp_ending csp_begin(const csp_program *program)
{
    if (!built) {
        return CSP_NOT_INITIALIZED;
    }
    built = false;
    running = program;
    ending = CSP_MORE;
    reached = 0;
    entered = false;
    csp_begin_driving(program);
    if ((program->environment != NULL) && (program->environment->start != NULL) && !program->environment->start()) {
        return environment_failed();
    }
    csp_instants_begin(program);
    program->process->party.flags = 0U;
    program->process->party.state = 0U;
    csp_ready(&program->process->party);
    return ending;
}

csp_ending csp_advance(int64_t until, uint32_t steps)
{
    uint32_t left = steps;
    if ((running == NULL) || (ending != CSP_MORE)) {
        return (running == NULL) ? CSP_NOT_INITIALIZED : ending;
    }
    if ((until < reached) || (until > CSP_END_OF_TIME)) {
        return CSP_REFUSED;
    }
    begin_turn();
    if (entered && !csp_port_virtual_time && !catch_up(until)) {
        return ending;
    }
    entered = true;
    for (;;) {
        const bool ready = csp_run_ready(&left);
        if (has_ended()) {
            return ended_by_itself();
        }
        if (CSP_LOAD(stop_requested)) {
            return end_with(CSP_STOPPED);
        }
        if (ready) {
            return CSP_BUDGET;
        }
        if (CSP_LOAD(news)) {
            take_over(csp_port_virtual_time ? reached : until);
            continue;
        }
        if ((csp_timer_next() == INT64_MAX) && !can_come(running)) {
            return end_with(CSP_DEADLOCK);
        }
        const int64_t instant = csp_instants_next();
        if (instant > until) {
            reached = until;
            return CSP_MORE;
        }
        if (!meet(instant, until)) {
            return environment_failed();
        }
        begin_turn();
    }
}

int64_t csp_next(void)
{
    if ((running == NULL) || (ending != CSP_MORE)) {
        return INT64_MAX;
    }
    return (csp_is_ready() || CSP_LOAD(news)) ? reached : csp_instants_next();
}

void csp_finish(void)
{
    csp_release_outputs();
    running = NULL;
}
