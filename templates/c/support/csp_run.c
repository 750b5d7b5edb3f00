/* SPDX-License-Identifier: 0BSD */
/* A whole run on a platform: steps of csp_advance, and waiting between them. */
#include "csp_internal.h"
#include "csp_port.h"

/* The number of steps of processes between checks of the clock. In real time a process with a higher priority waits for one step of another process, not
 * for all that are ready. */
enum { STEPS_IN_REAL_TIME = (CSP_LEVELS > 1U) ? 1 : 64, STEPS_IN_VIRTUAL_TIME = 65536 };

static int64_t earlier(int64_t one, int64_t other)
{
    return (one < other) ? one : other;
}

/* The instant of the next change of a parameter; INT64_MAX: none. */
static int64_t next_change(csp_kernel *csp)
{
    const csp_tuning *const tuning = csp->program->tuning;
    return (tuning != NULL) ? tuning->next() : INT64_MAX;
}

static csp_ending run_in_virtual_time(csp_kernel *csp, int64_t last)
{
    csp_ending ending = CSP_BUDGET;
    int64_t until = -1;
    while ((ending == CSP_BUDGET) || ((ending == CSP_MORE) && (until < last))) {
        const int64_t next = csp_next(csp);
        if ((ending == CSP_MORE) && (next <= last)) { /* before everything else at this instant */
            csp->program->tuning->make(csp, next);
        }
        until = (next <= last) ? earlier(last, next_change(csp) - 1) : last;
        ending = csp_advance(csp, until, STEPS_IN_VIRTUAL_TIME);
    }
    return ending;
}

static csp_ending run_in_real_time(csp_kernel *csp, int64_t last)
{
    int64_t until = 0;
    csp_ending ending = csp_advance(csp, until, STEPS_IN_REAL_TIME);
    while (((ending == CSP_MORE) || (ending == CSP_BUDGET)) && (until < last)) {
        if (ending == CSP_MORE) {
            csp_port_wait_until(earlier(csp_next(csp), last));
        }
        until = earlier(csp_port_now(), last);
        if (ending == CSP_MORE) { /* All processes wait: a change is made before the next instant, not within one. */
            const int64_t next = earlier(csp_next(csp), until);
            if (next_change(csp) <= next) {
                csp->program->tuning->make(csp, next);
            }
            until = earlier(until, next_change(csp) - 1);
        }
        ending = csp_advance(csp, until, STEPS_IN_REAL_TIME);
    }
    return ending;
}

csp_ending csp_run(csp_kernel *csp, int64_t until)
{
    const int64_t last = ((until >= 0) && (until < CSP_END_OF_TIME)) ? until : CSP_END_OF_TIME;
    csp_own(csp);
    csp_ending ending = csp_begin(csp);
    if (ending == CSP_NOT_INITIALIZED) {
        return ending;
    }
    if (ending == CSP_MORE) {
        csp_port_start();
        ending = csp->real_time ? run_in_real_time(csp, last) : run_in_virtual_time(csp, last);
    }
    if ((ending == CSP_MORE) || (ending == CSP_BUDGET)) {
        ending = CSP_TIME_LIMIT;
        csp->now = last;
    }
    csp_finish(csp);
    csp_port_finish(csp);
    return ending;
}
