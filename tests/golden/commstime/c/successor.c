/* SPDX-License-Identifier: 0BSD */
#include "successor.h"

#include "csp_arithmetic.h"

/* Where the process waits, and where it continues after a failure. */
enum {
    READS_INPUT = 1,
    WRITES_OUTPUT,
    FAILS
};

static csp_party *successor_step(csp_kernel *csp, csp_party *party)
{
    struct successor *const self = CSP_ENCLOSING(party, struct successor, process);
    csp_progress progress;

    switch (party->state) {
    case 0:
        csp_observe_begin(csp, party->number);
        for (;;) {
            /* input ? value (commstime.csp:42) */
            if (csp_refused(csp, party)) {
                goto fails;
            }
            CSP_AWAIT(csp_channel_read(csp, party, self->input, &self->value, sizeof(self->value)),
                CSP_DONE, READS_INPUT, fails)
            /* output ! value + 1 (commstime.csp:42) */
            self->sent.output = csp_add(csp, self->value, 1);
            if (csp_raised(csp, party, "commstime.csp:42")) {
                goto fails;
            }
            if (csp_refused(csp, party)) {
                goto fails;
            }
            CSP_AWAIT(csp_channel_write(csp, party, self->output, &self->sent.output,
                    sizeof(self->sent.output)),
                CSP_DONE, WRITES_OUTPUT, fails)
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

static const csp_place successor_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "commstime.csp:33"},
    [READS_INPUT] = {
        .waiting = CSP_AT_READ,
        .indirect = true,
        .failed = FAILS,
        .where = "commstime.csp:42",
        .offset = offsetof(struct successor, input)
    },
    [WRITES_OUTPUT] = {
        .waiting = CSP_AT_WRITE,
        .indirect = true,
        .failed = FAILS,
        .where = "commstime.csp:42",
        .offset = offsetof(struct successor, output)
    },
    [FAILS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "commstime.csp:33"}
};

static const csp_class successor_class = {
    .step = successor_step,
    .places = successor_places,
    .name = "Successor",
    .where = "commstime.csp:33",
    .offset = 0,
    .states = CSP_STATES(successor_places)
};

void successor_initialize(struct successor *self, csp_numbers *numbers,
    const struct successor_ports *ports)
{
    csp_process_init(&self->process, &successor_class, numbers->process);
    numbers->process++;
    self->input = ports->input;
    self->output = ports->output;
}
