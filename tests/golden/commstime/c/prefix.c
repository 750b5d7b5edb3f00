/* SPDX-License-Identifier: 0BSD */
#include "prefix.h"

/* Where the process waits, and where it continues after a failure. */
enum {
    WRITES_OUTPUT = 1,
    READS_INPUT,
    FAILS
};

static csp_party *prefix_step(csp_kernel *csp, csp_party *party)
{
    struct prefix *const self = CSP_ENCLOSING(party, struct prefix, process);
    csp_progress progress;

    switch (party->state) {
    case 0:
        csp_observe_begin(csp, party->number);
        for (;;) {
            /* output ! value (commstime.csp:14) */
            if (csp_refused(csp, party)) {
                goto fails;
            }
            CSP_AWAIT(
                csp_channel_write(csp, party, self->output, &self->value, sizeof(self->value)),
                CSP_DONE, WRITES_OUTPUT, fails)
            /* input ? value (commstime.csp:14) */
            if (csp_refused(csp, party)) {
                goto fails;
            }
            CSP_AWAIT(csp_channel_read(csp, party, self->input, &self->value, sizeof(self->value)),
                CSP_DONE, READS_INPUT, fails)
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

static const csp_place prefix_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "commstime.csp:5"},
    [WRITES_OUTPUT] = {
        .waiting = CSP_AT_WRITE,
        .indirect = true,
        .failed = FAILS,
        .where = "commstime.csp:14",
        .offset = offsetof(struct prefix, output)
    },
    [READS_INPUT] = {
        .waiting = CSP_AT_READ,
        .indirect = true,
        .failed = FAILS,
        .where = "commstime.csp:14",
        .offset = offsetof(struct prefix, input)
    },
    [FAILS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "commstime.csp:5"}
};

static const csp_class prefix_class = {
    .step = prefix_step,
    .places = prefix_places,
    .name = "Prefix",
    .where = "commstime.csp:5",
    .offset = 0,
    .states = CSP_STATES(prefix_places)
};

void prefix_initialize(struct prefix *self, csp_numbers *numbers, const struct prefix_ports *ports,
    int64_t first)
{
    csp_process_init(&self->process, &prefix_class, numbers->process);
    numbers->process++;
    self->input = ports->input;
    self->output = ports->output;
    self->value = first;
}
