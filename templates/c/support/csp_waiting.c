/* SPDX-License-Identifier: 0BSD */
/* Which processes wait, and for what. */
#include "csp_internal.h"

/* ---- Which processes ---- */

/* The innermost process of a task. */
static const csp_process *innermost(const csp_process *task)
{
    const csp_process *process = task;
    while (csp_place_of(process)->waiting == (uint8_t)CSP_AT_CALL) {
        process = (const csp_process *)csp_object_at(process, csp_place_of(process));
    }
    return process;
}

static bool waits_for_branches(const csp_process *process)
{
    const csp_parallel *const parallel = csp_parallel_of(process);
    return (parallel != NULL) && (parallel->pending > 0U);
}

void csp_report_waiting(csp_kernel *csp, csp_report *report, void *context)
{
    csp_process *task = csp_outermost(csp);
    while (task != NULL) {
        const csp_process *parent = innermost(task);
        if (waits_for_branches(parent)) {
            csp_parallel *const parallel = csp_parallel_of(parent);
            parallel->run = 0U;
            parallel->index = 0U;
        } else {
            const csp_waiting_process waiting = {parent, csp_place_of(parent)};
            report(csp, &waiting, context);
            parent = csp_parent_of(task);
        }
        task = NULL;
        while ((parent != NULL) && (task == NULL)) {
            task = csp_next_branch(csp_parallel_of(parent));
            if (task == NULL) {
                parent = csp_parent_of(csp_task_of((csp_process *)(void *)(uintptr_t)parent));
            } else if ((task->party.flags & (unsigned)CSP_ENDED) != 0U) {
                task = NULL;
            } else {
                /* Continue with the next process that waits. */
            }
        }
    }
}

/* ---- For what ---- */

static void name(const csp_medium *medium, csp_wait_entry *entry)
{
    entry->named = medium != NULL;
    entry->medium = medium;
    if (medium != NULL) {
        entry->channel = medium->number;
    }
}

static void entry_of_guard(const csp_guard *guard, csp_wait_entry *entry)
{
    switch (guard->kind) {
    case CSP_GUARD_OUTPUT:
        entry->words = "to write";
        break;
    case CSP_GUARD_AFTER:
        entry->words = "after";
        entry->duration = guard->at.timer->duration;
        break;
    case CSP_GUARD_SKIP:
        entry->words = "skip";
        break;
    default:
        entry->words = "to read";
        break;
    }
    name(guard->medium, entry);
}

static bool wait_of_alternative(const csp_alternative *alternative, uint32_t index, csp_wait_entry *entry)
{
    if (alternative->offers || alternative->pledged) {
        entry_of_guard(&alternative->guard[alternative->chosen], entry);
        return index == 0U;
    }
    uint32_t count = 0U;
    for (uint32_t guard = 0U; guard < alternative->count; guard++) {
        if (csp_is_enabled(&alternative->guard[guard])) {
            if (count == index) {
                entry_of_guard(&alternative->guard[guard], entry);
                return true;
            }
            count++;
        }
    }
    entry->words = "for an alternative of which no guard is enabled";
    return (index == 0U) && (count == 0U);
}

static bool wait_of_offers(const csp_offers *offers, bool reads, uint32_t index, csp_wait_entry *entry)
{
    uint32_t count = 0U;
    for (uint32_t used = 0U; used < offers->used; used++) {
        const csp_offer *const offer = &offers->offer[used];
        if (offer->waits) {
            if (count == index) {
                entry->words = reads ? "to read" : "to write";
                name(offer->medium, entry);
                return true;
            }
            count++;
        }
    }
    return false;
}

bool csp_wait_of(const csp_waiting_process *waiting, uint32_t index, csp_wait_entry *entry)
{
    const csp_place *const place = waiting->place;
    const void *const object = csp_object_at(waiting->process, place);
    entry->words = "";
    entry->named = false;
    entry->medium = NULL;
    entry->channel = 0U;
    entry->duration = 0;
    switch (place->waiting) {
    case CSP_AT_READ:
    case CSP_AT_WRITE:
        entry->words = (place->waiting == (uint8_t)CSP_AT_READ) ? "to read" : "to write";
        name((const csp_medium *)object, entry);
        return index == 0U;
    case CSP_AT_ALTERNATIVE:
        return wait_of_alternative((const csp_alternative *)object, index, entry);
    case CSP_AT_INPUTS:
    case CSP_AT_OUTPUTS:
        return wait_of_offers((const csp_offers *)object, place->waiting == (uint8_t)CSP_AT_INPUTS, index, entry);
    case CSP_AT_DELAY:
        entry->words = "until";
        entry->duration = ((const csp_timer *)object)->instant;
        return index == 0U;
    case CSP_AT_STOP:
        entry->words = "forever, at stop";
        return index == 0U;
    case CSP_AT_OVERWRITTEN:
        entry->words = "forever";
        return index == 0U;
    case CSP_AT_INTERRUPT:
        return wait_of_alternative(&((const csp_interrupt *)object)->alternative, index, entry);
    default:
        return false;
    }
}
