/* Timers: a pairing heap of nodes that are owned by their users. */
#include "csp_internal.h"

csp_timer *csp_earliest;
static uint64_t begun;

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

void csp_timers_reset(void)
{
    csp_earliest = NULL;
    begun = 0U;
}

int64_t csp_after(int64_t duration)
{
    return (duration < (INT64_MAX - csp.now)) ? (csp.now + duration) : (INT64_MAX - 1);
}

static csp_timer *take_earliest(void)
{
    csp_timer *const timer = csp_earliest;
    timer->runs = false;
    csp_earliest = meld_siblings(timer->child);
    return timer;
}

static void take_later(csp_timer *timer)
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
        csp_earliest = meld(csp_earliest, below);
    }
}

bool csp_timer_stop(csp_timer *timer)
{
    if (!timer->runs) {
        return false;
    }
    if (timer == csp_earliest) {
        (void)take_earliest();
    } else {
        take_later(timer);
    }
    return true;
}

void csp_timer_begin(csp_timer *timer, int64_t instant)
{
    if (timer->runs) {
        (void)csp_timer_stop(timer); /* a timer is in the heap at most once */
    }
    timer->instant = instant;
    timer->begun = begun;
    begun++;
    timer->child = NULL;
    timer->sibling = NULL;
    timer->previous = NULL;
    timer->runs = true;
    csp_earliest = (csp_earliest == NULL) ? timer : meld(csp_earliest, timer);
}

void csp_timers_fall_due(int64_t instant)
{
    while ((csp_earliest != NULL) && (csp_earliest->instant <= instant)) {
        csp_timer *const timer = take_earliest();
        if (timer->party != NULL) {
            csp_ready(timer->party);
        } else {
            csp_raise_all(timer->guard);
        }
    }
}

csp_progress csp_wait(csp_party *party, csp_timer *timer, int64_t duration)
{
    if (csp_is_cancelled(party)) {
        return csp_refuse(party);
    }
    if (duration <= 0) {
        return CSP_DONE;
    }
    timer->party = party;
    csp_timer_begin(timer, csp_after(duration));
    return CSP_WAITS;
}

csp_progress csp_stop(csp_party *party)
{
    return csp_is_cancelled(party) ? csp_refuse(party) : CSP_WAITS;
}
