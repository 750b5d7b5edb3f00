/* SPDX-License-Identifier: 0BSD */
/* Interrupt: a process that is abandoned at its next communication once a guard is ready.
 *
 * The body is a branch of its own. Meanwhile the guard waits like that of an alternative, so an alternative on the other side may choose
 * it; otherwise it communicates after the body has ended. If the body ends by itself, the guard does not communicate.
 */
#include "csp_internal.h"

void csp_interrupt_init(csp_interrupt *interrupt, uint32_t body)
{
    interrupt->branch.offset = body;
    interrupt->branch.count = 1U;
}

/* Initializes the alternative again, with its one guard. */
static void renew(csp_interrupt *interrupt)
{
    csp_alternative *const alternative = &interrupt->alternative;
    csp_alternative_init(alternative, &interrupt->guard, 1U, NULL, true);
    alternative->ready = 0U;
    alternative->attending = 0U;
    alternative->time_outs = 0U;
    alternative->waits = false;
    alternative->enrolls = false;
    alternative->armed = false;
    alternative->woken = false;
    alternative->solved = false;
    alternative->offers = false;
    alternative->pledged = false;
    interrupt->guard.attends = false;
    interrupt->guard.is_enrolled = false;
    csp_enable_all(alternative);
}

void csp_interrupt_prepare(csp_interrupt *interrupt)
{
    renew(interrupt);
    interrupt->alternative.interrupt = interrupt;
}

bool csp_interrupt_waits(const csp_interrupt *interrupt)
{
    return interrupt->body_ended;
}

void csp_interrupt_wake(csp_kernel *csp, csp_interrupt *interrupt)
{
    interrupt->body.run = 0U;
    interrupt->body.index = 0U;
    csp_cancel(csp, csp_next_branch(&interrupt->body), interrupt);
}

void csp_interrupt_retract(csp_kernel *csp, csp_interrupt *interrupt)
{
    csp_alternative *const alternative = &interrupt->alternative;
    if (alternative->waits) {
        csp_end_waiting(csp, alternative);
    }
    if (csp_is_pledged(alternative) && csp_withdraw(interrupt->guard.medium, &alternative->pledge)) {
        alternative->pledged = false;
        alternative->solved = false;
    }
}

bool csp_interrupt_withdraw(csp_kernel *csp, csp_interrupt *interrupt, csp_party *party)
{
    bool withdrawn = false;
    if (interrupt->communicates) {
        withdrawn = csp_alternative_withdraw(csp, &interrupt->alternative, party);
    } else if (interrupt->body_ended && csp_is_pledged(&interrupt->alternative)) {
        csp_interrupt_retract(csp, interrupt);
        withdrawn = !csp_is_pledged(&interrupt->alternative);
    } else {
        /* The body has ended, and the process is already in the ready queue. */
    }
    if (withdrawn) {
        csp_unwatch_guard(&interrupt->guard);
    }
    return withdrawn;
}

void csp_body_ended(csp_kernel *csp, csp_interrupt *interrupt, bool cancelled)
{
    if (!cancelled && interrupt->alternative.waits) {
        csp_end_waiting(csp, &interrupt->alternative);
    }
}

csp_progress csp_interruptible(csp_kernel *csp, csp_party *party, csp_interrupt *interrupt)
{
    csp_alternative *const alternative = &interrupt->alternative;
    if (csp_is_cancelled(party)) {
        csp_unwatch_guard(&interrupt->guard);
        return csp_refuse(csp, party);
    }
    interrupt->body_ended = false;
    interrupt->communicates = false;
    interrupt->taken = false;
    (void)csp_par(csp, party, &interrupt->body, &interrupt->branch, 1U);
    interrupt->body.interrupt = interrupt;
    csp_begin_waiting(csp, party, alternative);
    if ((alternative->ready != 0U) || ((alternative->time_outs > 0U) && csp_time_outs_passed(alternative))) {
        alternative->woken = true;
        csp_interrupt_wake(csp, interrupt);
    }
    return CSP_WAITS;
}

/* Makes the communication of the guard, unless the other side has chosen the guard and made it. */
static csp_progress communicate(csp_kernel *csp, csp_party *party, csp_interrupt *interrupt)
{
    csp_guard *const guard = &interrupt->guard;
    renew(interrupt);
    interrupt->alternative.interrupt = NULL;
    if ((CSP_USES_OUTPUT_GUARDS != 0) && (guard->kind == (uint8_t)CSP_GUARD_OUTPUT)) {
        csp_watch_output(csp, guard);
    } else {
        csp_watch_input(csp, guard);
    }
    interrupt->communicates = true;
    return csp_select_any(csp, party, &interrupt->alternative);
}

csp_progress csp_interruptible_again(csp_kernel *csp, csp_party *party, csp_interrupt *interrupt)
{
    csp_alternative *const alternative = &interrupt->alternative;
    csp_progress progress = CSP_DONE;
    if (interrupt->communicates) {
        progress = csp_select_again(csp, party, alternative);
    } else {
        if (!interrupt->body_ended) {
            interrupt->body_ended = true;
            if (csp_par_again(csp, party, &interrupt->body) == CSP_FAILS) {
                csp_interrupt_retract(csp, interrupt);
                csp_unwatch_guard(&interrupt->guard);
                return CSP_FAILS;
            }
        }
        if (csp_is_pledged(alternative) && csp_is_cancelled(party)) {
            csp_interrupt_retract(csp, interrupt);
            if (!csp_is_pledged(alternative)) {
                csp_unwatch_guard(&interrupt->guard);
                return csp_refuse(csp, party);
            }
        }
        if (csp_is_pledged(alternative)) {
            return CSP_WAITS;
        }
        csp_interrupt_retract(csp, interrupt);
        csp_unwatch_guard(&interrupt->guard);
        interrupt->taken = csp_is_solved(alternative) || (alternative->woken && interrupt->body.cancelled);
        if (!interrupt->taken || csp_is_solved(alternative)) {
            return CSP_DONE;
        }
        if (interrupt->guard.medium == NULL) {
            return csp_is_cancelled(party) ? csp_refuse(csp, party) : CSP_DONE;
        }
        progress = communicate(csp, party, interrupt);
    }
    if (progress != CSP_WAITS) {
        csp_unwatch_guard(&interrupt->guard);
    }
    return progress;
}
