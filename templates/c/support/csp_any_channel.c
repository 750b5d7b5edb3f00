/* SPDX-License-Identifier: 0BSD */
/* The rendezvous of any writer with any reader, plain or in alternatives.
 *
 * At most one of the two queues of waiting parties is not empty. Parties are served first come, first served, and before
 * alternatives. An alternative is enrolled (`reading`, `writing`) exactly while it waits with an enabled guard on a channel with
 * alternatives on the other side as well.
 */
#include "csp_internal.h"

void csp_channel_init(csp_channel *channel, uint32_t number)
{
    channel->medium.number = number;
    channel->medium.kind = (uint8_t)CSP_CHANNEL;
    channel->waiting = NULL;
}

void csp_guarded_init(csp_guarded_channel *channel, uint32_t number)
{
    channel->channel.medium.number = number;
    channel->channel.medium.kind = (uint8_t)CSP_GUARDED;
}

void csp_any_init(csp_any_channel *channel, uint32_t number)
{
    channel->medium.number = number;
    channel->medium.kind = (uint8_t)CSP_ANY;
}

void csp_any_left(csp_any_channel *channel)
{
    if ((channel->writers.first == NULL) && (channel->writing == NULL)) {
        csp_lower_bits(channel->inputs);
    }
    if ((channel->readers.first == NULL) && (channel->reading == NULL)) {
        csp_lower_bits(channel->outputs);
    }
}

csp_progress csp_any_take(csp_kernel *csp, csp_party *party, csp_any_channel *channel, void *value, size_t size)
{
    if (channel->writers.first != NULL) {
        csp_any_from_writer(csp, party, channel, value, size);
        return CSP_DONE;
    }
    csp_guard *const writing = channel->writing;
    csp_copy(value, writing->at.slot, size);
    csp_observe(csp, channel->medium.number, value, writing->alternative->process->number, party->number);
    csp_resolve(csp, writing);
    return CSP_DONE;
}

void csp_any_settle(csp_kernel *csp, csp_any_channel *channel)
{
    if (channel->writers.first == NULL) {
        csp_guard *const writing = channel->writing;
        if (channel->readers.first != NULL) {
            csp_resolve(csp, writing);
            csp_any_to_reader(csp, writing->alternative->process, channel, writing->at.slot, writing->size);
        } else {
            csp_party *const pledge = csp_pledge(csp, writing);
            (void)csp_any_write(csp, pledge, channel, writing->at.slot, writing->size);
        }
    }
}

csp_progress csp_any_choose_output(csp_kernel *csp, csp_party *party, csp_any_channel *channel, void *value, size_t size)
{
    if (channel->readers.first != NULL) {
        csp_any_to_reader(csp, party, channel, value, size);
        return CSP_DONE;
    }
    csp_guard *const reading = channel->reading;
    if (reading->kind == (uint8_t)CSP_GUARD_READY) {
        csp_resolve(csp, reading);
        return csp_any_write(csp, party, channel, value, size);
    }
    csp_copy(reading->at.slot, value, size);
    csp_observe(csp, channel->medium.number, value, party->number, reading->alternative->process->number);
    csp_resolve(csp, reading);
    return CSP_DONE;
}
