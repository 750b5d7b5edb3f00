/* SPDX-License-Identifier: 0BSD */
/* Cancellation: a process ends at its next communication; if it waits, that is the one for which it waits. */
#include "csp_internal.h"

bool csp_withdraw(csp_medium *medium, csp_party *party)
{
    (void)party;
    switch (medium->kind) {
#if CSP_USES_CHANNELS
    case CSP_CHANNEL: {
        csp_channel *const channel = (csp_channel *)(void *)medium;
        const bool waited = channel->waiting == party;
        if (waited) {
            channel->waiting = NULL;
        }
        return waited;
    }
#endif
#if CSP_USES_GUARDED_CHANNELS
    case CSP_GUARDED: {
        csp_guarded_channel *const channel = (csp_guarded_channel *)(void *)medium;
        const bool waited = channel->channel.waiting == party;
        if (waited) {
            channel->channel.waiting = NULL;
            csp_lower_bits(channel->inputs);
        }
        return waited;
    }
#endif
#if CSP_USES_ANY_CHANNELS
    case CSP_ANY: {
        csp_any_channel *const channel = (csp_any_channel *)(void *)medium;
        const bool waited = csp_remove(&channel->readers, party) || csp_remove(&channel->writers, party);
        csp_any_left(channel);
        return waited;
    }
#endif
#if CSP_USES_BROADCASTS
    case CSP_BROADCAST: {
        csp_broadcast *const channel = (csp_broadcast *)(void *)medium;
        const bool waited = channel->writer == party;
        if (waited) {
            channel->writer = NULL;
            csp_broadcast_recall(channel);
        }
        return waited;
    }
    case CSP_BROADCAST_END: {
        csp_broadcast_end *const end = (csp_broadcast_end *)(void *)medium;
        const bool waited = end->reader == party;
        if (waited) {
            end->reader = NULL;
            csp_broadcast_reader_left(end->channel);
        }
        return waited;
    }
#endif
#if CSP_USES_BUFFERS
    case CSP_BUFFER: {
        csp_buffer *const buffer = (csp_buffer *)(void *)medium;
        const bool reads = buffer->reader == party;
        const bool writes = buffer->writer == party;
        if (reads) {
            buffer->reader = NULL;
        }
        if (writes) {
            buffer->writer = NULL;
        }
        return reads || writes;
    }
#endif
#if CSP_USES_SAMPLED_INPUTS
    case CSP_SAMPLED_END: {
        csp_sampled_end *const end = (csp_sampled_end *)(void *)medium;
        const bool waited = end->reader == party;
        if (waited) {
            end->reader = NULL;
        }
        return waited;
    }
#endif
#if CSP_USES_EVENT_INPUTS
    case CSP_EVENT_END:
        return csp_remove(&((csp_event_end *)(void *)medium)->readers, party);
#endif
    default:
        return false;
    }
}

bool csp_is_registered(const csp_medium *medium, const csp_party *party)
{
    (void)party;
    switch (medium->kind) {
#if CSP_USES_CHANNELS
    case CSP_CHANNEL:
        return ((const csp_channel *)(const void *)medium)->waiting == party;
#endif
#if CSP_USES_GUARDED_CHANNELS
    case CSP_GUARDED:
        return ((const csp_guarded_channel *)(const void *)medium)->channel.waiting == party;
#endif
#if CSP_USES_ANY_CHANNELS
    case CSP_ANY: {
        const csp_any_channel *const channel = (const csp_any_channel *)(const void *)medium;
        return csp_contains(&channel->readers, party) || csp_contains(&channel->writers, party);
    }
#endif
#if CSP_USES_BROADCASTS
    case CSP_BROADCAST:
        return ((const csp_broadcast *)(const void *)medium)->writer == party;
    case CSP_BROADCAST_END:
        return ((const csp_broadcast_end *)(const void *)medium)->reader == party;
#endif
#if CSP_USES_BUFFERS
    case CSP_BUFFER: {
        const csp_buffer *const buffer = (const csp_buffer *)(const void *)medium;
        return (buffer->reader == party) || (buffer->writer == party);
    }
#endif
#if CSP_USES_SAMPLED_INPUTS
    case CSP_SAMPLED_END:
        return ((const csp_sampled_end *)(const void *)medium)->reader == party;
#endif
#if CSP_USES_EVENT_INPUTS
    case CSP_EVENT_END:
        return csp_contains(&((const csp_event_end *)(const void *)medium)->readers, party);
#endif
    default:
        return false;
    }
}

bool csp_withdraw_process(csp_kernel *csp, csp_process *process)
{
    (void)csp;
    const csp_place *const place = csp_place_of(process);
    void *const object = csp_object_at(process, place);
    switch (place->waiting) {
    case CSP_AT_READ:
    case CSP_AT_WRITE:
        return csp_withdraw((csp_medium *)object, &process->party);
#if CSP_USES_ALTERNATIVES
    case CSP_AT_ALTERNATIVE:
        return csp_alternative_withdraw(csp, (csp_alternative *)object, &process->party);
#endif
#if CSP_USES_OFFERS
    case CSP_AT_INPUTS:
    case CSP_AT_OUTPUTS:
        return csp_offers_withdraw(csp, (csp_offers *)object);
#endif
#if CSP_USES_DELAYS
    case CSP_AT_DELAY:
        return csp_timer_stop(csp, (csp_timer *)object);
#endif
    case CSP_AT_STOP:
    case CSP_AT_OVERWRITTEN:
        return true;
#if CSP_USES_INTERRUPTS
    case CSP_AT_INTERRUPT:
        return csp_interrupt_withdraw(csp, (csp_interrupt *)object, &process->party);
#endif
    default:
        return false;
    }
}

csp_parallel *csp_parallel_of(const csp_process *process)
{
    const csp_place *const place = csp_place_of(process);
    if (place->waiting == (uint8_t)CSP_AT_PARALLEL) {
        return (csp_parallel *)csp_object_at(process, place);
    }
#if CSP_USES_INTERRUPTS
    if (place->waiting == (uint8_t)CSP_AT_INTERRUPT) {
        return &((csp_interrupt *)csp_object_at(process, place))->body;
    }
#endif
    return NULL;
}

csp_process *csp_task_of(csp_process *process)
{
    csp_process *outermost = process;
    while (((outermost->party.flags & (unsigned)CSP_BRANCH) == 0U) && (outermost->above != NULL)) {
        outermost = (csp_process *)outermost->above;
    }
    return outermost;
}

/* Prepares the branches for cancellation, from the first one; withdraws the guard of an interrupt. */
static void abandon_branches(csp_kernel *csp, csp_process *process, csp_parallel *parallel)
{
#if CSP_USES_INTERRUPTS
    const csp_place *const place = csp_place_of(process);
    if (place->waiting == (uint8_t)CSP_AT_INTERRUPT) {
        csp_interrupt_retract(csp, (csp_interrupt *)csp_object_at(process, place));
    }
#else
    (void)csp;
    (void)process;
#endif
    parallel->abandoned = true;
    parallel->run = 0U;
    parallel->index = 0U;
}

#if CSP_USES_INTERRUPTS
/* The running process itself has made the guard ready that interrupts it, and may be about to wait in that same communication. The
 * canceller is in the ready queue before anything that a partner could cause; when it runs, the process waits or has ended. */
static csp_party *cancel_waiting(csp_kernel *csp, csp_party *party)
{
    csp_interrupt *const interrupt =
        (csp_interrupt *)(void *)((char *)party - offsetof(csp_interrupt, canceller));
    csp_process *const victim = interrupt->victim;
    interrupt->victim = NULL;
    if ((victim->party.flags & (unsigned)CSP_ENDED) != 0U) {
        return NULL;
    }
    csp_parallel *const parallel = csp_parallel_of(victim);
    if ((parallel != NULL) && (parallel->pending > 0U)) {
        abandon_branches(csp, victim, parallel);
        for (csp_process *branch = csp_next_branch(parallel); branch != NULL; branch = csp_next_branch(parallel)) {
            csp_cancel(csp, branch, NULL);
        }
        return NULL;
    }
    if (!csp_withdraw_process(csp, victim)) {
        return NULL;
    }
    victim->party.state = csp_place_of(victim)->failed;
    victim->party.flags |= (uint8_t)CSP_ABANDONED;
    return &victim->party;
}

#endif

static void cancel_running(csp_kernel *csp, csp_process *process, csp_interrupt *interrupt)
{
#if CSP_USES_INTERRUPTS
    if (interrupt == NULL) {
        return;
    }
    const bool queued = interrupt->victim != NULL;
    interrupt->victim = process;
    if (!queued) {
        interrupt->canceller.step = cancel_waiting;
        interrupt->canceller.level = process->party.level;
        csp_ready(csp, &interrupt->canceller);
    }
#else
    (void)csp;
    (void)process;
    (void)interrupt;
#endif
}

/* Cancels what a task waits for. Returns the innermost process if its branches have to be cancelled next, or NULL. */
static csp_process *cancel_task(csp_kernel *csp, csp_process *task, csp_interrupt *interrupt)
{
    csp_process *process = task;
    if ((task->party.flags & ((unsigned)CSP_CANCELLED | (unsigned)CSP_ENDED)) != 0U) {
        return NULL;
    }
    for (;;) {
        process->party.flags |= (uint8_t)CSP_CANCELLED;
        if (&process->party == csp->current) {
            cancel_running(csp, process, interrupt);
            return NULL;
        }
        const csp_place *const place = csp_place_of(process);
        if (place->waiting != (uint8_t)CSP_AT_CALL) {
            break;
        }
        process = (csp_process *)csp_object_at(process, place);
    }
    csp_parallel *const parallel = csp_parallel_of(process);
    if ((parallel != NULL) && (parallel->pending > 0U)) {
        abandon_branches(csp, process, parallel);
        return process;
    }
    if (csp_withdraw_process(csp, process)) {
        process->party.state = csp_place_of(process)->failed;
        process->party.flags |= (uint8_t)CSP_ABANDONED;
        csp_ready(csp, &process->party);
    }
    return NULL;
}

void csp_cancel(csp_kernel *csp, csp_process *branch, csp_interrupt *interrupt)
{
    csp_process *task = branch;
    while (task != NULL) {
        csp_process *parent = cancel_task(csp, task, interrupt);
        if (parent == NULL) {
            parent = (task == branch) ? NULL : csp_parent_of(task);
        }
        task = NULL;
        while ((parent != NULL) && (task == NULL)) {
            task = csp_next_branch(csp_parallel_of(parent));
            if (task == NULL) {
                const csp_process *const above = csp_task_of(parent);
                parent = (above == branch) ? NULL : csp_parent_of(above);
            }
        }
    }
}
