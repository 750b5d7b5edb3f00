/* SPDX-License-Identifier: 0BSD */
/* Guards of alternatives at channels and ends. */
#include "csp_internal.h"

void csp_watch(csp_guard **watchers, csp_guard *guard)
{
    csp_guard **last = watchers;
    while (*last != NULL) {
        last = &(*last)->next;
    }
    guard->next = NULL;
    *last = guard;
}

void csp_unwatch(csp_guard **watchers, csp_guard *guard)
{
    csp_guard **found = watchers;
    while ((*found != NULL) && (*found != guard)) {
        found = &(*found)->next;
    }
    if (*found != NULL) {
        *found = guard->next;
    }
}

#if CSP_USES_ANY_CHANNELS
static bool began_before(const csp_guard *one, const csp_guard *other)
{
    return (other->alternative->began - one->alternative->began) < (UINT32_MAX / 2U);
}

/* Keeps the order in which the alternatives began to wait; they enrol later than that if the other side becomes an alternative later. */
static void enroll_at(csp_guard **enrolled, csp_guard *guard)
{
    csp_guard **place = enrolled;
    while ((*place != NULL) && began_before(*place, guard)) {
        place = &(*place)->enrolled;
    }
    guard->enrolled = *place;
    *place = guard;
}

static void dismiss_from(csp_guard **enrolled, const csp_guard *guard)
{
    csp_guard **found = enrolled;
    while ((*found != NULL) && (*found != guard)) {
        found = &(*found)->enrolled;
    }
    if (*found != NULL) {
        *found = guard->enrolled;
    }
}
#endif

void csp_set_attends(csp_guard *guard, bool attends)
{
    if (attends && !guard->attends) {
        guard->alternative->attending++;
    }
    if (!attends && guard->attends) {
        guard->alternative->attending--;
    }
    guard->attends = attends;
}

void csp_attend(csp_kernel *csp, csp_guard *watchers)
{
    for (csp_guard *guard = watchers; guard != NULL; guard = guard->next) {
        csp_set_attends(guard, true);
        if (guard->alternative->waits && csp_is_enabled(guard) && !guard->is_enrolled) {
            csp_enroll(csp, guard);
        }
    }
}

#if CSP_USES_GUARDED_CHANNELS
/* Finds out anew which guard of a channel is the only one. */
static void find_sole(csp_guarded_channel *channel)
{
    csp_guard *const first = channel->inputs;
    channel->sole = ((first != NULL) && (first->next == NULL)) ? first : NULL;
    for (csp_guard *guard = first; guard != NULL; guard = guard->next) {
        guard->direct = (guard == channel->sole) && (guard->kind == (uint8_t)CSP_GUARD_INPUT);
    }
}
#endif

void csp_watch_input(csp_kernel *csp, csp_guard *guard)
{
    (void)csp;
    switch (guard->medium->kind) {
#if CSP_USES_GUARDED_CHANNELS
    case CSP_GUARDED: {
        csp_guarded_channel *const channel = (csp_guarded_channel *)(void *)guard->medium;
        csp_watch(&channel->inputs, guard);
        find_sole(channel);
        if (channel->channel.waiting != NULL) {
            csp_set_bit(guard);
        }
        break;
    }
#endif
#if CSP_USES_ANY_CHANNELS
    case CSP_ANY: {
        csp_any_channel *const channel = (csp_any_channel *)(void *)guard->medium;
        csp_watch(&channel->inputs, guard);
        if ((channel->writers.first != NULL) || (channel->writing != NULL)) {
            csp_set_bit(guard);
        }
        if (channel->outputs != NULL) {
            csp_set_attends(guard, true);
            csp_attend(csp, channel->outputs);
        }
        break;
    }
#endif
#if CSP_USES_BUFFERS
    case CSP_BUFFER: {
        csp_buffer *const buffer = (csp_buffer *)(void *)guard->medium;
        csp_watch(&buffer->inputs, guard);
        if (buffer->stored > 0U) {
            csp_set_bit(guard);
        }
        break;
    }
#endif
#if CSP_USES_BROADCASTS
    case CSP_BROADCAST_END: {
        csp_broadcast_end *const end = (csp_broadcast_end *)(void *)guard->medium;
        csp_watch(&end->inputs, guard);
        if (end->fresh) {
            csp_set_bit(guard);
        }
        if (end->channel->outputs != NULL) {
            csp_set_attends(guard, true);
        }
        break;
    }
#endif
#if CSP_USES_SAMPLED_INPUTS
    case CSP_SAMPLED_END: {
        csp_sampled_end *const end = (csp_sampled_end *)(void *)guard->medium;
        csp_watch(&end->inputs, guard);
        if (end->fresh) {
            csp_set_bit(guard);
        }
        if (!end->begun) {
            csp_set_attends(guard, true);
        }
        break;
    }
#endif
#if CSP_USES_EVENT_INPUTS
    case CSP_EVENT_END: {
        csp_event_end *const end = (csp_event_end *)(void *)guard->medium;
        csp_watch(&end->inputs, guard);
        if (end->fresh) {
            csp_set_bit(guard);
        }
        break;
    }
#endif
    default:
        break;
    }
}

void csp_watch_output(csp_kernel *csp, csp_guard *guard)
{
    (void)csp;
    switch (guard->medium->kind) {
#if CSP_USES_ANY_CHANNELS
    case CSP_ANY: {
        csp_any_channel *const channel = (csp_any_channel *)(void *)guard->medium;
        csp_watch(&channel->outputs, guard);
        if ((channel->readers.first != NULL) || (channel->reading != NULL)) {
            csp_set_bit(guard);
        }
        if (channel->inputs != NULL) {
            csp_set_attends(guard, true);
            csp_attend(csp, channel->inputs);
        }
        break;
    }
#endif
#if CSP_USES_BUFFERS
    case CSP_BUFFER: {
        csp_buffer *const buffer = (csp_buffer *)(void *)guard->medium;
        if (!buffer->overwrites) {
            csp_watch(&buffer->outputs, guard);
        }
        if (buffer->overwrites || (buffer->stored < buffer->capacity)) {
            csp_set_bit(guard);
        }
        break;
    }
#endif
#if CSP_USES_BROADCASTS
    case CSP_BROADCAST: {
        csp_broadcast *const channel = (csp_broadcast *)(void *)guard->medium;
        csp_watch(&channel->outputs, guard);
        for (csp_broadcast_end *end = channel->ends; end != NULL; end = end->next) {
            csp_attend(csp, end->inputs);
        }
        csp_broadcast_readers_changed(csp, channel);
        break;
    }
#endif
    default:
        break;
    }
}

void csp_unwatch_guard(csp_guard *guard)
{
    if (guard->medium == NULL) {
        return;
    }
    switch (guard->medium->kind) {
#if CSP_USES_GUARDED_CHANNELS
    case CSP_GUARDED: {
        csp_guarded_channel *const channel = (csp_guarded_channel *)(void *)guard->medium;
        csp_unwatch(&channel->inputs, guard);
        guard->direct = false;
        find_sole(channel);
        break;
    }
#endif
#if CSP_USES_ANY_CHANNELS
    case CSP_ANY: {
        csp_any_channel *const channel = (csp_any_channel *)(void *)guard->medium;
        csp_unwatch(&channel->inputs, guard);
        csp_unwatch(&channel->outputs, guard);
        break;
    }
#endif
#if CSP_USES_BUFFERS
    case CSP_BUFFER: {
        csp_buffer *const buffer = (csp_buffer *)(void *)guard->medium;
        csp_unwatch(&buffer->inputs, guard);
        csp_unwatch(&buffer->outputs, guard);
        break;
    }
#endif
#if CSP_USES_BROADCASTS
    case CSP_BROADCAST:
        csp_unwatch(&((csp_broadcast *)(void *)guard->medium)->outputs, guard);
        break;
    case CSP_BROADCAST_END:
        csp_unwatch(&((csp_broadcast_end *)(void *)guard->medium)->inputs, guard);
        break;
#endif
#if CSP_USES_SAMPLED_INPUTS
    case CSP_SAMPLED_END:
        csp_unwatch(&((csp_sampled_end *)(void *)guard->medium)->inputs, guard);
        break;
#endif
#if CSP_USES_EVENT_INPUTS
    case CSP_EVENT_END:
        csp_unwatch(&((csp_event_end *)(void *)guard->medium)->inputs, guard);
        break;
#endif
    default:
        break;
    }
}

void csp_enroll(csp_kernel *csp, csp_guard *guard)
{
    (void)csp;
    guard->is_enrolled = true;
    guard->alternative->enrolls = true;
    switch (guard->medium->kind) {
#if CSP_USES_ANY_CHANNELS
    case CSP_ANY: {
        csp_any_channel *const channel = (csp_any_channel *)(void *)guard->medium;
        const bool writes = guard->kind == (uint8_t)CSP_GUARD_OUTPUT;
        enroll_at(writes ? &channel->writing : &channel->reading, guard);
        csp_raise_bits(csp, writes ? channel->inputs : channel->outputs);
        break;
    }
#endif
#if CSP_USES_BROADCASTS
    case CSP_BROADCAST_END: {
        csp_broadcast_end *const end = (csp_broadcast_end *)(void *)guard->medium;
        end->waiting = guard;
        csp_broadcast_readers_changed(csp, end->channel);
        break;
    }
#endif
#if CSP_USES_SAMPLED_INPUTS
    case CSP_SAMPLED_END:
        csp_sampled_begin((csp_sampled_end *)(void *)guard->medium);
        break;
#endif
    default:
        break; /* other media do not keep waiting alternatives */
    }
}

void csp_dismiss(csp_guard *guard)
{
    guard->is_enrolled = false;
    switch (guard->medium->kind) {
#if CSP_USES_ANY_CHANNELS
    case CSP_ANY: {
        csp_any_channel *const channel = (csp_any_channel *)(void *)guard->medium;
        dismiss_from((guard->kind == (uint8_t)CSP_GUARD_OUTPUT) ? &channel->writing : &channel->reading, guard);
        csp_any_left(channel);
        break;
    }
#endif
#if CSP_USES_BROADCASTS
    case CSP_BROADCAST_END: {
        csp_broadcast_end *const end = (csp_broadcast_end *)(void *)guard->medium;
        end->waiting = NULL;
        csp_broadcast_reader_left(end->channel);
        break;
    }
#endif
    default:
        break; /* as in csp_enroll */
    }
}

csp_progress csp_take(csp_kernel *csp, csp_party *party, csp_guard *guard)
{
    (void)csp;
    (void)party;
    switch (guard->medium->kind) {
#if CSP_USES_GUARDED_CHANNELS
    case CSP_GUARDED:
        return csp_guarded_read(csp, party, (csp_guarded_channel *)(void *)guard->medium, guard->at.slot, guard->size);
#endif
#if CSP_USES_ANY_CHANNELS
    case CSP_ANY:
        return csp_any_take(csp, party, (csp_any_channel *)(void *)guard->medium, guard->at.slot, guard->size);
#endif
#if CSP_USES_BUFFERS
    case CSP_BUFFER:
        csp_buffer_take(csp, party, (csp_buffer *)(void *)guard->medium, guard->at.slot, guard->size);
        return CSP_DONE;
#endif
#if CSP_USES_BROADCASTS
    case CSP_BROADCAST_END:
        csp_broadcast_taken(csp, party, (csp_broadcast_end *)(void *)guard->medium, guard->at.slot, guard->size);
        return CSP_DONE;
#endif
#if CSP_USES_SAMPLED_INPUTS
    case CSP_SAMPLED_END:
        return csp_sampled_take(csp, party, (csp_sampled_end *)(void *)guard->medium, guard->at.slot, guard->size);
#endif
#if CSP_USES_EVENT_INPUTS
    case CSP_EVENT_END:
        csp_event_take(csp, party, (csp_event_end *)(void *)guard->medium, guard->at.slot, guard->size);
        return CSP_DONE;
#endif
    default:
        return CSP_DONE;
    }
}

void csp_settle_input(csp_kernel *csp, csp_guard *guard)
{
    (void)csp;
    (void)guard;
#if CSP_USES_ANY_CHANNELS
    if (guard->medium->kind == (uint8_t)CSP_ANY) {
        csp_any_settle(csp, (csp_any_channel *)(void *)guard->medium);
    }
#endif
}

csp_progress csp_choose_output(csp_kernel *csp, csp_party *party, csp_guard *guard)
{
    (void)csp;
    (void)party;
    switch (guard->medium->kind) {
#if CSP_USES_ANY_CHANNELS
    case CSP_ANY:
        return csp_any_choose_output(csp, party, (csp_any_channel *)(void *)guard->medium, guard->at.slot, guard->size);
#endif
#if CSP_USES_BUFFERS
    case CSP_BUFFER:
        return csp_buffer_write(csp, party, (csp_buffer *)(void *)guard->medium, guard->at.slot, guard->size);
#endif
#if CSP_USES_BROADCASTS
    case CSP_BROADCAST:
        return csp_broadcast_choose_output(csp, party, (csp_broadcast *)(void *)guard->medium, guard->at.slot, guard->size);
#endif
    default:
        return CSP_DONE;
    }
}
