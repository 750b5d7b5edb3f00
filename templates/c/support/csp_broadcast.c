/* SPDX-License-Identifier: 0BSD */
/* The broadcast channel: every reading end gets every value.
 *
 * An end is fresh from a write until its reader has taken the value. The writer waits while any end is fresh.
 */
#include "csp_internal.h"

void csp_broadcast_init(csp_broadcast *channel, uint32_t number)
{
    channel->medium.number = number;
    channel->medium.kind = (uint8_t)CSP_BROADCAST;
}

void csp_broadcast_end_init(csp_broadcast_end *end, csp_broadcast *channel)
{
    end->medium.number = channel->medium.number;
    end->medium.kind = (uint8_t)CSP_BROADCAST_END;
    end->channel = channel;
    end->next = NULL;
    csp_broadcast_end **last = &channel->ends;
    while (*last != NULL) {
        last = &(*last)->next;
    }
    *last = end;
    csp_broadcast_readers_changed(NULL, channel); /* nothing waits before the program starts */
}

static bool all_awaited(const csp_broadcast *channel)
{
    const csp_broadcast_end *end = channel->ends;
    while ((end != NULL) && ((end->reader != NULL) || (end->waiting != NULL))) {
        end = end->next;
    }
    return end == NULL;
}

static bool any_fresh(const csp_broadcast *channel, const csp_broadcast_end *except)
{
    const csp_broadcast_end *end = channel->ends;
    while ((end != NULL) && (!end->fresh || (end == except))) {
        end = end->next;
    }
    return end != NULL;
}

void csp_broadcast_readers_changed(csp_kernel *csp, const csp_broadcast *channel)
{
    if (channel->outputs != NULL) {
        if (all_awaited(channel)) {
            csp_raise_bits(csp, channel->outputs);
        } else {
            csp_lower_bits(channel->outputs);
        }
    }
}

void csp_broadcast_reader_left(const csp_broadcast *channel)
{
    if ((channel->outputs != NULL) && !all_awaited(channel)) {
        csp_lower_bits(channel->outputs);
    }
}

void csp_broadcast_recall(const csp_broadcast *channel)
{
    for (csp_broadcast_end *end = channel->ends; end != NULL; end = end->next) {
        end->fresh = false;
        csp_lower_bits(end->inputs);
    }
}

static void receive(csp_kernel *csp, const csp_party *party, csp_broadcast_end *end, const void *value, size_t size)
{
    if (end->resolved) {
        end->resolved = false;
    } else if (end->reader != NULL) {
        csp_party *const reader = end->reader;
        end->reader = NULL;
        csp_copy(reader->slot, value, size);
        csp_ready(csp, reader);
        csp_broadcast_readers_changed(csp, end->channel);
        csp_observe(csp, end->medium.number, value, party->number, reader->number);
    } else {
        end->fresh = true;
        csp_raise_bits(csp, end->inputs);
    }
}

csp_progress csp_broadcast_write(csp_kernel *csp, csp_party *party, csp_broadcast *channel, void *value, size_t size)
{
    channel->writer = party;
    party->slot = value;
    for (csp_broadcast_end *end = channel->ends; end != NULL; end = end->next) {
        receive(csp, party, end, value, size);
    }
    if (any_fresh(channel, NULL)) {
        return CSP_WAITS;
    }
    channel->writer = NULL;
    return CSP_DONE;
}

csp_progress csp_broadcast_choose_output(csp_kernel *csp, csp_party *party, csp_broadcast *channel, void *value, size_t size)
{
    for (csp_broadcast_end *end = channel->ends; end != NULL; end = end->next) {
        csp_guard *const guard = end->waiting;
        if (guard != NULL) {
            if (guard->kind != (uint8_t)CSP_GUARD_READY) {
                csp_copy(guard->at.slot, value, size);
                end->resolved = true;
                csp_observe(csp, channel->medium.number, value, party->number, guard->alternative->process->number);
            }
            csp_resolve(csp, guard);
        }
    }
    return csp_broadcast_write(csp, party, channel, value, size);
}

void csp_broadcast_taken(csp_kernel *csp, csp_party *party, csp_broadcast_end *end, void *value, size_t size)
{
    csp_broadcast *const channel = end->channel;
    csp_party *const writer = channel->writer;
    csp_copy(value, writer->slot, size);
    if (!any_fresh(channel, end)) {
        csp_ready(csp, writer);
        channel->writer = NULL;
    }
    end->fresh = false;
    csp_lower_bits(end->inputs);
    csp_observe(csp, channel->medium.number, value, writer->number, party->number);
}

csp_progress csp_broadcast_read(csp_kernel *csp, csp_party *party, csp_broadcast_end *end, void *value, size_t size)
{
    if (end->fresh) {
        csp_broadcast_taken(csp, party, end, value, size);
        return CSP_DONE;
    }
    party->slot = value;
    end->reader = party;
    csp_broadcast_readers_changed(csp, end->channel);
    return CSP_WAITS;
}
