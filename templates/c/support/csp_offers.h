/* SPDX-License-Identifier: 0BSD */
/* Concurrent communications, with which a control law reads its inputs and writes its outputs. */
#ifndef CSP_OFFERS_H
#define CSP_OFFERS_H

#include "csp_core.h"

typedef struct csp_offers csp_offers;

/* One of several communications; `party.slot` is the variable. */
typedef struct csp_offer {
    csp_party party;
    csp_offers *offers;
    csp_medium *medium; /* where it waits */
    uint32_t size;      /* of the value */
    bool waits;
    bool collects; /* reads an input from outside: takes what has arrived when it runs */
} csp_offer;

/* A member of the struct of the process, with an array of as many csp_offer as there are concurrent communications at most. */
struct csp_offers {
    csp_party *process;
    csp_offer *offer;
    uint32_t capacity;
    uint32_t used;
    uint32_t waiting;
    bool failed; /* a sample was missed; see csp->error */
};

void csp_offers_init(csp_offers *offers, csp_offer *offer, uint32_t capacity);

/* Begins the offers; CSP_FAILS if the process was cancelled. */
csp_progress csp_offers_begin(csp_kernel *csp, csp_party *party, csp_offers *offers);

/* Adds a communication; `operation` is the read or write function of the channel or end. If the result is CSP_FAILS, the process continues in the failed state of
 * the place of CSP_AWAIT(csp_offers_wait(offers), csp_offers_again(party, offers), PLACE, FAILED), which follows. */
#define CSP_OFFER(offers, operation, channel, variable)                                                                \
    csp_offer_made(csp, (offers), CSP_MEDIUM(channel), sizeof(variable),                                               \
                   csp_offer_refused(csp, (offers), CSP_MEDIUM(channel))                                               \
                       ? CSP_FAILS                                                                                     \
                       : operation(csp, csp_offer_next(offers), (channel), &(variable), sizeof(variable)))

/* Whether an earlier offer has caused the cancellation of the process, and this one would find a partner; then the process ends here. */
bool csp_offer_meets(csp_kernel *csp, csp_offers *offers, const csp_medium *medium);
static inline bool csp_offer_refused(csp_kernel *csp, csp_offers *offers, const csp_medium *medium)
{
    return csp_is_cancelled(offers->process) && csp_offer_meets(csp, offers, medium);
}

/* The party of the next offer, to be passed to the read or write function of a channel or end. */
static inline csp_party *csp_offer_next(csp_offers *offers)
{
    return &offers->offer[offers->used].party;
}

/* To be called with the result of the read or write function for csp_offer_next. If that is CSP_FAILS, all other offers are given up. */
csp_progress csp_offer_made(csp_kernel *csp, csp_offers *offers, csp_medium *medium, size_t size, csp_progress progress);

/* Withdraws the offers that wait, because something else has failed between them. */
void csp_offers_give_up(csp_kernel *csp, csp_offers *offers);

csp_progress csp_offers_wait(csp_offers *offers);
csp_progress csp_offers_again(csp_party *party, csp_offers *offers);

#endif
