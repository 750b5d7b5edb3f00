/* SPDX-License-Identifier: 0BSD */
/* Timers: a pairing heap of nodes that are owned by their users. */
#include "csp_internal.h"

static bool comes_before(const csp_timer *one, const csp_timer *other)
{
    return (one->instant < other->instant) || ((one->instant == other->instant) && (one->begun < other->begun));
}

/* Merges two heaps: the later one becomes the first child of the earlier one, whose own links stay as they are. */
static csp_timer *meld(csp_timer *one, csp_timer *other)
{
    csp_timer *parent = one;
    csp_timer *child = other;
    if (comes_before(other, one)) {
        parent = other;
        child = one;
    }
    child->sibling = parent->child;
    child->previous = parent;
    if (parent->child != NULL) {
        parent->child->previous = child;
    }
    parent->child = child;
    return parent;
}

/* Merges siblings into one heap: in pairs from the left, then the pairs from the right. */
static csp_timer *meld_siblings(csp_timer *first)
{
    csp_timer *pairs = NULL; /* linked by `sibling`, the last first */
    csp_timer *next = first;
    while (next != NULL) {
        csp_timer *const one = next;
        csp_timer *const other = one->sibling;
        csp_timer *pair = one;
        next = NULL;
        if (other != NULL) {
            next = other->sibling;
            pair = meld(one, other);
        }
        pair->sibling = pairs;
        pairs = pair;
    }
    csp_timer *heap = pairs;
    if (heap != NULL) {
        pairs = heap->sibling;
        while (pairs != NULL) {
            csp_timer *const pair = pairs;
            pairs = pair->sibling;
            heap = meld(heap, pair);
        }
        heap->sibling = NULL;
        heap->previous = NULL;
    }
    return heap;
}

int64_t csp_after(csp_kernel *csp, int64_t duration)
{
    return (duration < (INT64_MAX - csp->now)) ? (csp->now + duration) : (INT64_MAX - 1);
}

static csp_timer *take_earliest(csp_kernel *csp)
{
    csp_timer *const timer = csp->earliest;
    timer->runs = false;
    csp->earliest = meld_siblings(timer->child);
    return timer;
}

static void take_later(csp_kernel *csp, csp_timer *timer)
{
    timer->runs = false;
    csp_timer *const below = meld_siblings(timer->child);
    if (timer->previous->child == timer) {
        timer->previous->child = timer->sibling;
    } else {
        timer->previous->sibling = timer->sibling;
    }
    if (timer->sibling != NULL) {
        timer->sibling->previous = timer->previous;
    }
    if (below != NULL) {
        csp->earliest = meld(csp->earliest, below);
    }
}

bool csp_timer_stop(csp_kernel *csp, csp_timer *timer)
{
    if (!timer->runs) {
        return false;
    }
    if (timer == csp->earliest) {
        (void)take_earliest(csp);
    } else {
        take_later(csp, timer);
    }
    return true;
}

void csp_timer_begin(csp_kernel *csp, csp_timer *timer, int64_t instant)
{
    if (timer->runs) {
        (void)csp_timer_stop(csp, timer); /* a timer is in the heap at most once */
    }
    timer->instant = instant;
    timer->begun = csp->timers_begun;
    csp->timers_begun++;
    timer->child = NULL;
    timer->sibling = NULL;
    timer->previous = NULL;
    timer->runs = true;
    csp->earliest = (csp->earliest == NULL) ? timer : meld(csp->earliest, timer);
}

void csp_timers_fall_due(csp_kernel *csp, int64_t instant)
{
    while ((csp->earliest != NULL) && (csp->earliest->instant <= instant)) {
        csp_timer *const timer = take_earliest(csp);
#if CSP_USES_TIME_OUTS
        if (timer->party == NULL) {
            csp_raise_all(csp, timer->guard);
            continue;
        }
#endif
        csp_ready(csp, timer->party);
    }
}

csp_progress csp_wait(csp_kernel *csp, csp_party *party, csp_timer *timer, int64_t duration)
{
    if (csp_is_cancelled(party)) {
        return csp_refuse(csp, party);
    }
    if (duration <= 0) {
        return CSP_DONE;
    }
    timer->party = party;
    csp_timer_begin(csp, timer, csp_after(csp, duration));
    return CSP_WAITS;
}

csp_progress csp_stop(csp_kernel *csp, csp_party *party)
{
    return csp_is_cancelled(party) ? csp_refuse(csp, party) : CSP_WAITS;
}
