/* SPDX-License-Identifier: 0BSD */
/* Concurrent communications: begun in the order of the ports; the process continues when the last of them is complete. */
#include "csp_internal.h"

static void prepare(csp_offers *offers)
{
    if (offers->used < offers->capacity) {
        csp_party *const party = &offers->offer[offers->used].party;
        party->number = offers->process->number;
        party->level = offers->process->level;
    }
}

/* Marks an offer as neither waiting nor in the ready queue. */
static void forget(csp_kernel *csp, csp_offer *offer)
{
    if (offer->waits) {
        if (!csp_withdraw(offer->medium, &offer->party)) {
            csp_unready(csp, &offer->party);
        }
        offer->waits = false;
        offer->offers->waiting--;
    }
}

void csp_offers_give_up(csp_kernel *csp, csp_offers *offers)
{
    for (uint32_t index = 0U; index < offers->used; index++) {
        forget(csp, &offers->offer[index]);
    }
}

bool csp_offers_withdraw(csp_kernel *csp, csp_offers *offers)
{
    bool waited = false;
    for (uint32_t index = 0U; index < offers->used; index++) {
        csp_offer *const offer = &offers->offer[index];
        if (offer->waits && csp_withdraw(offer->medium, &offer->party)) {
            offer->waits = false;
            offers->waiting--;
            waited = true;
        }
    }
    if (waited) {
        csp_offers_give_up(csp, offers);
    }
    return waited;
}

static void done(csp_offer *offer)
{
    offer->waits = false;
    offer->offers->waiting--;
}

/* Takes what has arrived from outside for an offer. Returns false if it is gone; the offer then waits again. */
static bool collect(csp_kernel *csp, csp_offer *offer)
{
    const csp_party *const process = offer->offers->process;
    csp_progress progress = CSP_FAILS;
    switch (offer->medium->kind) {
#if CSP_USES_EVENT_INPUTS
    case CSP_EVENT_END: {
        csp_event_end *const end = (csp_event_end *)(void *)offer->medium;
        if (csp_is_cancelled(process)) {
            csp_event_pass_on(csp, end);
            (void)csp_refuse(csp, process);
        } else if (end->fresh) {
            csp_event_take(csp, &offer->party, end, offer->party.slot, offer->size);
            progress = CSP_DONE;
        } else {
            csp_enter_front(&end->readers, &offer->party);
            progress = CSP_WAITS;
        }
        break;
    }
#endif
#if CSP_USES_SAMPLED_INPUTS
    case CSP_SAMPLED_END:
        if (csp_is_cancelled(process)) {
            (void)csp_refuse(csp, process);
        } else {
            csp_sampled_end *const end = (csp_sampled_end *)(void *)offer->medium;
            progress = csp_sampled_read(csp, &offer->party, end, offer->party.slot, offer->size);
        }
        break;
#endif
    default:
        (void)process;
        break;
    }
    if (progress == CSP_FAILS) {
        done(offer);
        offer->offers->failed = true;
        csp_offers_give_up(csp, offer->offers);
        return true;
    }
    if (progress == CSP_DONE) {
        done(offer);
    }
    return progress == CSP_DONE;
}

static bool has_arrived(const csp_offer *offer)
{
    if (offer->medium->kind == (uint8_t)CSP_EVENT_END) {
        return ((const csp_event_end *)(const void *)offer->medium)->fresh;
    }
    return ((const csp_sampled_end *)(const void *)offer->medium)->fresh;
}

/* The process runs because of `readied`: takes, in the order of the ports, whatever else has arrived. */
static void collect_all(csp_kernel *csp, csp_offers *offers, csp_offer *readied)
{
    for (uint32_t index = 0U; index < offers->used; index++) {
        csp_offer *const offer = &offers->offer[index];
        if (!offer->waits) {
            continue;
        }
        if (offer == readied) {
            (void)collect(csp, offer);
        } else if (offer->collects) {
            if (has_arrived(offer)) {
                if (!csp_withdraw(offer->medium, &offer->party)) {
                    csp_unready(csp, &offer->party);
                }
                (void)collect(csp, offer);
            }
        } else if (!csp_is_registered(offer->medium, &offer->party)) {
            csp_unready(csp, &offer->party);
            done(offer);
        } else {
            /* It still waits. */
        }
    }
}

static csp_party *offer_step(csp_kernel *csp, csp_party *party)
{
    csp_offer *const offer = (csp_offer *)(void *)party;
    csp_offers *const offers = offer->offers;
    if (offer->collects) {
        collect_all(csp, offers, offer);
    } else {
        done(offer);
    }
    return (offers->waiting == 0U) ? offers->process : NULL;
}

void csp_offers_init(csp_offers *offers, csp_offer *offer, uint32_t capacity)
{
    offers->offer = offer;
    offers->capacity = capacity;
    for (uint32_t index = 0U; index < capacity; index++) {
        offer[index].party.step = offer_step;
        offer[index].party.flags = CSP_OFFERED;
        offer[index].offers = offers;
    }
}

csp_progress csp_offers_begin(csp_kernel *csp, csp_party *party, csp_offers *offers)
{
    if (csp_is_cancelled(party)) {
        return csp_refuse(csp, party);
    }
    offers->process = party;
    offers->used = 0U;
    offers->waiting = 0U;
    offers->failed = false;
    prepare(offers);
    return CSP_DONE;
}

bool csp_offer_meets(csp_kernel *csp, csp_offers *offers, const csp_medium *medium)
{
    bool meets = false;
    switch (medium->kind) {
#if CSP_USES_CHANNELS
    case CSP_CHANNEL:
        meets = ((const csp_channel *)(const void *)medium)->waiting != NULL;
        break;
#endif
#if CSP_USES_GUARDED_CHANNELS
    case CSP_GUARDED:
        meets = ((const csp_guarded_channel *)(const void *)medium)->channel.waiting != NULL;
        break;
#endif
#if CSP_USES_ANY_CHANNELS
    case CSP_ANY: {
        const csp_any_channel *const channel = (const csp_any_channel *)(const void *)medium;
        meets = (channel->readers.first != NULL) || (channel->writers.first != NULL);
        break;
    }
#endif
#if CSP_USES_BUFFERS
    case CSP_BUFFER:
        meets = ((const csp_buffer *)(const void *)medium)->reader != NULL;
        break;
#endif
#if CSP_USES_BROADCASTS
    case CSP_BROADCAST_END:
        meets = ((const csp_broadcast_end *)(const void *)medium)->fresh;
        break;
#endif
    default:
        break;
    }
    if (meets) {
        (void)csp_refuse(csp, offers->process);
    }
    return meets;
}

csp_progress csp_offer_made(csp_kernel *csp, csp_offers *offers, csp_medium *medium, size_t size, csp_progress progress)
{
    if (progress == CSP_FAILS) {
        csp_offers_give_up(csp, offers);
        return CSP_FAILS;
    }
    if (progress == CSP_WAITS) {
        csp_offer *const offer = &offers->offer[offers->used];
        offer->medium = medium;
        offer->size = (uint32_t)size;
        offer->waits = true;
        offer->collects =
            (medium->kind == (uint8_t)CSP_SAMPLED_END) || (medium->kind == (uint8_t)CSP_EVENT_END);
        offers->used++;
        offers->waiting++;
        prepare(offers);
    }
    return CSP_DONE;
}

csp_progress csp_offers_wait(csp_offers *offers)
{
    return (offers->waiting == 0U) ? CSP_DONE : CSP_WAITS;
}

csp_progress csp_offers_again(csp_party *party, csp_offers *offers)
{
    (void)party;
    return offers->failed ? CSP_FAILS : CSP_DONE;
}
