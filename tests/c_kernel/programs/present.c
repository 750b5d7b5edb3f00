/* What another thread sees of the running process, and of one of the communications that it has offered. */
#include <stdio.h>

#include "csp_internal.h"

static csp_party *never(csp_party *party)
{
    (void)party;
    return NULL;
}

static const csp_place places[] = {
    {.waiting = CSP_AT_NOTHING, .where = "present.csp:1"},
    {.waiting = CSP_AT_INPUTS, .where = "present.csp:7"},
};
static const csp_class kind = {.step = never, .places = places, .name = "Law", .where = "present.csp:1"};
static csp_process process;
static csp_offers offers;
static csp_offer offer[2];
static const csp_program program = {.process = &process};

static void show(csp_party *party)
{
    char text[80] = "";
    csp.current = party;
    csp_describe_at_work(text, sizeof text);
    (void)printf("at work: %s\n", text);
    csp_describe_present(text, sizeof text);
    (void)printf("%s\n", text);
}

int main(void)
{
    csp_begin_building();
    csp_process_init(&process, &kind, 1U);
    csp_offers_init(&offers, offer, 2U);
    process.party.flags = 0U;
    (void)csp_offers_begin(&process.party, &offers);
    show(&process.party);
    csp_begin_driving(&program);
    show(NULL);
    show(&process.party);
    process.party.state = 1U;
    show(&process.party);
    show(&offer[1].party);
    csp_observe_loop("present.csp:9");
    show(&process.party);
    (void)csp_raise(&process.party, (uint16_t)CSP_FAULT_EXCEPTION, NULL);
    show(&process.party);
    return 0;
}
