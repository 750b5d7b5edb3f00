/* Timers: a pairing heap of nodes that are owned by their users. */
#include "csp_internal.h"

static csp_timer *root;
static uint64_t begun;

static bool comes_before(const csp_timer *one, const csp_timer *other)
{
    return (one->instant < other->instant) || ((one->instant == other->instant) && (one->begun < other->begun));
}

/* Merges two heaps, neither of which has siblings. */
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
    parent->sibling = NULL;
    parent->previous = NULL;
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
    csp_timer *heap = NULL;
    while (pairs != NULL) {
        csp_timer *const pair = pairs;
        pairs = pair->sibling;
        pair->sibling = NULL;
        pair->previous = NULL;
        heap = (heap == NULL) ? pair : meld(heap, pair);
    }
    return heap;
}

void csp_timers_reset(void)
{
    root = NULL;
    begun = 0U;
}

int64_t csp_after(int64_t duration)
{
    return (duration < (INT64_MAX - csp.now)) ? (csp.now + duration) : (INT64_MAX - 1);
}

static void take_out(csp_timer *timer)
{
    timer->runs = false;
    csp_timer *const below = meld_siblings(timer->child);
    if (timer == root) {
        root = below;
        return;
    }
    if (timer->previous->child == timer) {
        timer->previous->child = timer->sibling;
    } else {
        timer->previous->sibling = timer->sibling;
    }
    if (timer->sibling != NULL) {
        timer->sibling->previous = timer->previous;
    }
    if (below != NULL) {
        root = meld(root, below);
    }
}

bool csp_timer_stop(csp_timer *timer)
{
    if (!timer->runs) {
        return false;
    }
    take_out(timer);
    return true;
}

void csp_timer_begin(csp_timer *timer, int64_t instant)
{
    (void)csp_timer_stop(timer); /* a timer is in the heap at most once */
    timer->instant = instant;
    timer->begun = begun;
    begun++;
    timer->child = NULL;
    timer->sibling = NULL;
    timer->previous = NULL;
    timer->runs = true;
    root = (root == NULL) ? timer : meld(root, timer);
}

int64_t csp_timer_next(void)
{
    return (root == NULL) ? INT64_MAX : root->instant;
}

void csp_timers_fall_due(int64_t instant)
{
    while ((root != NULL) && (root->instant <= instant)) {
        csp_timer *const timer = root;
        take_out(timer);
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

csp_progress csp_wait_again(csp_party *party)
{
    (void)party;
    return CSP_DONE;
}

csp_progress csp_stop(csp_party *party)
{
    return csp_is_cancelled(party) ? csp_refuse(party) : CSP_WAITS;
}
