/* SPDX-License-Identifier: 0BSD */
#include "delta.h"

/* Where the process waits, and where it continues after a failure. */
enum {
    READS_INPUT = 1,
    WRITES_FIRST,
    WRITES_SECOND,
    FAILS
};

static csp_party *delta_step(csp_kernel *csp, csp_party *party)
{
    struct delta *const self = CSP_ENCLOSING(party, struct delta, process);
    csp_progress progress;

    switch (party->state) {
    case 0:
        csp_observe_begin(csp, party->number);
        for (;;) {
            /* input ? value (commstime.csp:28) */
            if (csp_refused(csp, party)) {
                goto fails;
            }
            CSP_AWAIT(csp_channel_read(csp, party, self->input, &self->value, sizeof(self->value)),
                CSP_DONE, READS_INPUT, fails)
            /* first ! value (commstime.csp:28) */
            if (csp_refused(csp, party)) {
                goto fails;
            }
            CSP_AWAIT(csp_channel_write(csp, party, self->first, &self->value, sizeof(self->value)),
                CSP_DONE, WRITES_FIRST, fails)
            /* second ! value (commstime.csp:28) */
            if (csp_refused(csp, party)) {
                goto fails;
            }
            CSP_AWAIT(
                csp_channel_write(csp, party, self->second, &self->value, sizeof(self->value)),
                CSP_DONE, WRITES_SECOND, fails)
        }
    case FAILS:
    fails:
        csp_unwind(csp, party);
        csp_observe_end(csp, party->number);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place delta_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "commstime.csp:19"},
    [READS_INPUT] = {
        .waiting = CSP_AT_READ,
        .indirect = true,
        .failed = FAILS,
        .where = "commstime.csp:28",
        .offset = offsetof(struct delta, input)
    },
    [WRITES_FIRST] = {
        .waiting = CSP_AT_WRITE,
        .indirect = true,
        .failed = FAILS,
        .where = "commstime.csp:28",
        .offset = offsetof(struct delta, first)
    },
    [WRITES_SECOND] = {
        .waiting = CSP_AT_WRITE,
        .indirect = true,
        .failed = FAILS,
        .where = "commstime.csp:28",
        .offset = offsetof(struct delta, second)
    },
    [FAILS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "commstime.csp:19"}
};

static const csp_class delta_class = {
    .step = delta_step,
    .places = delta_places,
    .name = "Delta",
    .where = "commstime.csp:19",
    .offset = 0,
    .states = CSP_STATES(delta_places)
};

void delta_initialize(struct delta *self, csp_numbers *numbers, const struct delta_ports *ports)
{
    csp_process_init(&self->process, &delta_class, numbers->process);
    numbers->process++;
    self->input = ports->input;
    self->first = ports->first;
    self->second = ports->second;
}
