/* SPDX-License-Identifier: 0BSD */
#include "consumer.h"
#include "types.h"

/* Where the process waits, and where it continues after a failure. */
enum {
    READS_INPUT = 1,
    FAILS
};

static csp_party *consumer_step(csp_kernel *csp, csp_party *party)
{
    struct consumer *const self = CSP_ENCLOSING(party, struct consumer, process);
    csp_progress progress;

    switch (party->state) {
    case 0:
        csp_observe_begin(csp, party->number);
        do {
            /* input ? value (commstime.csp:55) */
            if (csp_refused(csp, party)) {
                goto fails;
            }
            CSP_AWAIT(csp_channel_read(csp, party, self->input, &self->value, sizeof(self->value)),
                CSP_DONE, READS_INPUT, fails)
        } while (self->value != self->rounds - 1);
        /* raise Finished (commstime.csp:55) */
        (void)csp_raise(csp, party, EXCEPTION_FINISHED, "commstime.csp:55");
        goto fails;
    case FAILS:
    fails:
        csp_unwind(csp, party);
        csp_observe_end(csp, party->number);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place consumer_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "commstime.csp:47"},
    [READS_INPUT] = {
        .waiting = CSP_AT_READ,
        .indirect = true,
        .failed = FAILS,
        .where = "commstime.csp:55",
        .offset = offsetof(struct consumer, input)
    },
    [FAILS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "commstime.csp:47"}
};

static const csp_class consumer_class = {
    .step = consumer_step,
    .places = consumer_places,
    .name = "Consumer",
    .where = "commstime.csp:47",
    .offset = 0,
    .states = CSP_STATES(consumer_places)
};

void consumer_initialize(struct consumer *self, csp_numbers *numbers,
    const struct consumer_ports *ports, int64_t rounds)
{
    csp_process_init(&self->process, &consumer_class, numbers->process);
    numbers->process++;
    self->rounds = rounds;
    self->input = ports->input;
}
