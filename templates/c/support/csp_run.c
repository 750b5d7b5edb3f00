/* A run: when time advances, and how the run ends. */
#include "csp_arithmetic.h"
#include "csp_internal.h"
#include "csp_port.h"
#include "csp_shared.h"

/* The number of steps of processes between checks of the clock and of requests to stop. In real time a process with a higher priority waits for
 * one step of another process, not for all that are ready. */
enum { STEPS_IN_REAL_TIME = (CSP_LEVELS > 1U) ? 1 : 64, STEPS_IN_VIRTUAL_TIME = 65536 };

/* The last instant of any run in virtual time, after 292 years; later ones do not fit in int64_t. */
#define END_OF_TIME INT64_C(9223372036000000000)

static bool built;
static volatile bool stop_requested;
static volatile uint32_t iterations;
static uint32_t awaited; /* the port for which something waited last */

void csp_begin_building(void)
{
    (void)memset(&csp, 0, sizeof csp);
    csp_fault.describe = NULL;
    csp_timers_reset();
    CSP_STORE(stop_requested, false);
    awaited = 0U;
    built = true;
}

void csp_request_stop(void)
{
    CSP_STORE(stop_requested, true);
    csp_port_wake();
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

uint32_t csp_iterations(void)
{
    return CSP_LOAD(iterations);
}

static void begin_turn(void)
{
    CSP_NOTE(iterations, iterations + 1U);
    csp_port_alive();
}

static csp_ending run_in_virtual_time(const csp_program *program, int64_t until)
{
    const int64_t last = (until >= 0) ? earlier(until, END_OF_TIME) : END_OF_TIME;
    for (;;) {
        begin_turn();
        while (csp_run_ready(STEPS_IN_VIRTUAL_TIME)) {
            begin_turn();
            if (CSP_LOAD(stop_requested)) {
                return CSP_STOPPED;
            }
        }
        if (has_ended(program)) {
            return ended_by_itself();
        }
        if (CSP_LOAD(stop_requested)) {
            return CSP_STOPPED;
        }
        if ((csp_timer_next() == INT64_MAX) && !can_come(program)) {
            return CSP_DEADLOCK;
        }
        const int64_t instant = csp_instants_next();
        if (instant > last) {
            csp.now = last;
            return CSP_TIME_LIMIT;
        }
        if (!csp_instants_meet(program, instant, instant)) {
            return environment_failed();
        }
    }
}

static bool has_news(const csp_program *program)
{
    bool news = false;
    for (uint32_t index = 0U; (index < program->port_count) && !news; index++) {
        news = (program->ports[index].kind == CSP_PORT_EVENT) &&
               CSP_LOAD(((const csp_event_input *)(const void *)program->ports[index].medium)->news);
    }
    return news;
}

/* Makes events occur that interrupt handlers have brought, before the next instant. */
static void take_over(const csp_program *program)
{
    csp.now = later(csp.now, earlier(csp_port_now(), csp_instants_next() - 1));
    for (uint32_t index = 0U; index < program->port_count; index++) {
        if (program->ports[index].kind == CSP_PORT_EVENT) {
            csp_event_take_over((csp_event_input *)(void *)program->ports[index].medium);
        }
    }
}

/* Executes the instants that have passed. Those that pass meanwhile are left for the next iteration, so processes run in between even if devices are
 * slow. Returns whether the run continues; otherwise `ending` is how it has ended. */
static bool meet_the_past(const csp_program *program, int64_t until, csp_ending *ending)
{
    const int64_t present = csp_port_now();
    for (;;) {
        const int64_t due = csp_instants_next();
        const int64_t instant = (until >= 0) ? earlier(due, until) : due;
        if (CSP_LOAD(stop_requested)) {
            *ending = CSP_STOPPED;
            return false;
        }
        if (instant > present) {
            return true;
        }
        if (instant != due) {
            csp.now = until;
            *ending = CSP_TIME_LIMIT;
            return false;
        }
        csp_port_met(instant);
        if (!csp_instants_meet(program, instant, present)) {
            *ending = environment_failed();
            return false;
        }
    }
}

/* All instants that have passed are executed before the next steps of processes, so a process that computes too long misses samples. */
static csp_ending run_in_real_time(const csp_program *program, int64_t until)
{
    csp_ending ending = CSP_FAILED;
    for (;;) {
        begin_turn();
        const bool ready = csp_run_ready(STEPS_IN_REAL_TIME);
        if (has_ended(program)) {
            return ended_by_itself();
        }
        if (!ready && !can_come(program)) {
            return CSP_DEADLOCK;
        }
        if (!ready && !CSP_LOAD(stop_requested) && !has_news(program)) {
            const int64_t due = csp_instants_next();
            csp_port_wait_until((until >= 0) ? earlier(due, until) : due);
        }
        if (!meet_the_past(program, until, &ending)) {
            return ending;
        }
        if (has_news(program)) {
            take_over(program);
        }
    }
}

csp_ending csp_run(const csp_program *program, int64_t until)
{
    csp_ending ending = CSP_FAILED;
    if (!built) {
        return CSP_NOT_INITIALIZED;
    }
    built = false;
    csp_begin_driving(program);
    if ((program->environment != NULL) && (program->environment->start != NULL) && !program->environment->start()) {
        ending = environment_failed();
    } else {
        csp_instants_begin(program);
        program->process->party.flags = 0U;
        program->process->party.state = 0U;
        csp_ready(&program->process->party);
        csp_port_start();
        ending = csp_port_virtual_time ? run_in_virtual_time(program, until) : run_in_real_time(program, until);
    }
    csp_release_outputs();
    csp_port_finish(program);
    return ending;
}
