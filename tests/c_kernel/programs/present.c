/* What another thread sees of the running process, and of one of the communications that it has offered. */
#include <stdio.h>

#include "csp_internal.h"

static csp_party *never(csp_kernel *csp, csp_party *party)
{
    (void)csp;
    (void)party;
    return NULL;
}

static const csp_place places[] = {
    {.waiting = CSP_AT_NOTHING, .where = "present.csp:1"},
    {.waiting = CSP_AT_INPUTS, .where = "present.csp:7"},
};
static const csp_class kind = {.step = never, .places = places, .name = "Law", .where = "present.csp:1"};
static struct memory {
    csp_kernel kernel;
    csp_process process;
} memory;
static csp_offers offers;
static csp_offer offer[2];
static const csp_program program = {.process = offsetof(struct memory, process)};

static void show(csp_kernel *csp, csp_party *party)
{
    char text[80] = "";
    csp->current = party;
    csp_describe_at_work(csp, text, sizeof text);
    (void)printf("at work: %s\n", text);
    csp_describe_present(csp, text, sizeof text);
    (void)printf("%s\n", text);
    csp_describe_interrupted(csp, text, sizeof text);
    (void)printf("interrupted: %s\n", text);
}

int main(void)
{
    csp_kernel *const csp = &memory.kernel;
    csp_process *const process = &memory.process;
    csp_build(csp, &program, NULL);
    csp_process_init(process, &kind, 1U);
    csp_offers_init(&offers, offer, 2U);
    process->party.flags = 0U;
    (void)csp_offers_begin(csp, &process->party, &offers);
    show(csp, &process->party);
    csp_begin_driving(csp);
    show(csp, NULL);
    show(csp, &process->party);
    process->party.state = 1U;
    show(csp, &process->party);
    show(csp, &offer[1].party);
    csp_observe_loop(csp, "present.csp:9");
    show(csp, &process->party);
    (void)csp_raise(csp, &process->party, (uint16_t)CSP_FAULT_EXCEPTION, NULL);
    show(csp, &process->party);
    return 0;
}
