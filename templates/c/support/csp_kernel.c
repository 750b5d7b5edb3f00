/* SPDX-License-Identifier: 0BSD */
/* The scheduler: which process runs next. First come, first served within a level of priority. */
#include "csp_internal.h"
#include "csp_shared.h"

static inline csp_party *next_party(csp_kernel *csp)
{
    for (uint32_t level = 0U; level < CSP_LEVELS; level++) {
        csp_queue *const queue = &csp->ready[level];
        csp_party *const party = queue->first;
        if (party != NULL) {
            queue->first = party->next;
            return party;
        }
    }
    return NULL;
}

/* The number of processes that may follow each other in one step before requests to stop are checked. */
enum { LONGEST_STEP = 65536 };

static inline csp_party *run(csp_kernel *csp, csp_party *party)
{
    CSP_NOTE(csp->current, party);
    csp_measure_party(csp, party->number);
    return party->step(csp, party);
}

/* Runs the parties that follow one in the same step, until one has to wait. */
static void run_on(csp_kernel *csp, csp_party *first)
{
    csp_party *party = first;
    for (uint32_t count = 1U; (party != NULL) && (count < (uint32_t)LONGEST_STEP); count++) {
        party = run(csp, party);
    }
    if (party != NULL) {
        csp_enter_front(&csp->ready[(CSP_LEVELS > 1U) ? party->level : 0U], party);
    }
}

bool csp_is_ready(csp_kernel *csp)
{
    bool ready = false;
    for (uint32_t level = 0U; level < CSP_LEVELS; level++) {
        ready = ready || (csp->ready[level].first != NULL);
    }
    return ready;
}

bool csp_run_ready(csp_kernel *csp, uint32_t *steps)
{
    uint32_t left = *steps;
    csp_party *party = NULL;
    while (left > 0U) {
        party = next_party(csp);
        if (party == NULL) {
            break;
        }
        left--;
        csp_measure_begin(csp);
        csp_party *const following = run(csp, party);
        if (following != NULL) {
            run_on(csp, following);
        }
        csp_measure_end(csp);
    }
    CSP_NOTE(csp->current, NULL);
    *steps = left;
    return (left == 0U) && csp_is_ready(csp);
}

void csp_unready(csp_kernel *csp, csp_party *party)
{
    (void)csp_remove(&csp->ready[(CSP_LEVELS > 1U) ? party->level : 0U], party);
}

void csp_enter_front(csp_queue *queue, csp_party *party)
{
    if (queue->first == NULL) {
        queue->last = party;
    }
    party->next = queue->first;
    queue->first = party;
}

bool csp_remove(csp_queue *queue, const csp_party *party)
{
    csp_party *before = NULL;
    csp_party *found = queue->first;
    while ((found != NULL) && (found != party)) {
        before = found;
        found = found->next;
    }
    if (found == NULL) {
        return false;
    }
    if (before == NULL) {
        queue->first = found->next;
    } else {
        before->next = found->next;
        if (queue->last == found) {
            queue->last = before;
        }
    }
    return true;
}

bool csp_contains(const csp_queue *queue, const csp_party *party)
{
    const csp_party *found = queue->first;
    while ((found != NULL) && (found != party)) {
        found = found->next;
    }
    return found != NULL;
}
