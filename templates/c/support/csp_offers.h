/* Several communications offered at once: how a control law reads its inputs and writes its outputs. */
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
    bool collects; /* reads an input from outside: takes what has come when it runs */
} csp_offer;

/* A struct of the process has one, and an array of csp_offer, as many as are ever offered at once. */
struct csp_offers {
    csp_party *process;
    csp_offer *offer;
    uint32_t capacity;
    uint32_t used;
    uint32_t waiting;
    bool failed; /* a sample was missed: csp.error has it */
};

void csp_offers_init(csp_offers *offers, csp_offer *offer, uint32_t capacity);

/* Begins; CSP_FAILS where the process was cancelled. */
csp_progress csp_offers_begin(csp_party *party, csp_offers *offers);

/* One communication more; `operation` is the read or write function of the channel or end. PLACE is that of the CSP_AWAIT that follows:
 * CSP_AWAIT(csp_offers_wait(offers), csp_offers_again(party, offers), PLACE, FAILED) */
#define CSP_OFFER(offers, operation, channel, variable, PLACE, FAILED)                                                 \
    if (csp_offer_made((offers), &(channel)->medium, sizeof(variable),                                                 \
                       csp_offer_refused((offers), &(channel)->medium)                                                 \
                           ? CSP_FAILS                                                                                 \
                           : operation(csp_offer_next(offers), (channel), &(variable), sizeof(variable))) ==           \
        CSP_FAILS) {                                                                                                   \
        party->state = (uint16_t)(PLACE);                                                                              \
        goto FAILED;                                                                                                   \
    }

/* Whether the process was cancelled by an offer before and would now meet a partner; then it ends here. */
bool csp_offer_meets(csp_offers *offers, const csp_medium *medium);
static inline bool csp_offer_refused(csp_offers *offers, const csp_medium *medium)
{
    return csp_is_cancelled(offers->process) && csp_offer_meets(offers, medium);
}

/* The party of the next offer, to be given to the read or write function of a channel or end. */
static inline csp_party *csp_offer_next(csp_offers *offers)
{
    return &offers->offer[offers->used].party;
}

/* What the read or write function has answered for csp_offer_next. CSP_FAILS where it has failed: then all others were given up. */
csp_progress csp_offer_made(csp_offers *offers, csp_medium *medium, size_t size, csp_progress progress);

/* Takes back what waits: something else has failed between the offers. */
void csp_offers_give_up(csp_offers *offers);

csp_progress csp_offers_wait(csp_offers *offers);
csp_progress csp_offers_again(csp_party *party, csp_offers *offers);

#endif
