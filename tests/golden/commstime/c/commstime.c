/* SPDX-License-Identifier: 0BSD */
#include "commstime.h"
#include "types.h"

/* Where the process waits, and where it continues after a failure. */
enum {
    IN_PARALLEL = 1,
    CATCHES_FINISHED
};

static const csp_branches commstime_branches[] = {
    {.offset = offsetof(struct commstime, prefix.process), .stride = 0U, .count = 1U, .level = 0U},
    {.offset = offsetof(struct commstime, delta.process), .stride = 0U, .count = 1U, .level = 0U},
    {
        .offset = offsetof(struct commstime, successor.process),
        .stride = 0U,
        .count = 1U,
        .level = 0U
    },
    {.offset = offsetof(struct commstime, consumer.process), .stride = 0U, .count = 1U, .level = 0U}
};

static csp_party *commstime_step(csp_kernel *csp, csp_party *party)
{
    struct commstime *const self = CSP_ENCLOSING(party, struct commstime, process);
    csp_progress progress;

    switch (party->state) {
    case 0:
        csp_observe_begin(csp, party->number);
        /* prefix || delta || successor || consumer (commstime.csp:74) */
        CSP_AWAIT(csp_par(csp, party, &self->parallel, commstime_branches, 4U),
            csp_par_again(csp, party, &self->parallel), IN_PARALLEL, catches_finished)
        goto after_catches_finished;
    case CATCHES_FINISHED:
    catches_finished:
        csp_unwind(csp, party);
        if (!csp_catch(csp, EXCEPTION_FINISHED)) {
            goto fails;
        }
    after_catches_finished:
        csp_observe_end(csp, party->number);
        return csp_end(csp, party);
    fails:
        csp_unwind(csp, party);
        csp_observe_end(csp, party->number);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place commstime_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "commstime.csp:60"},
    [IN_PARALLEL] = {
        .waiting = CSP_AT_PARALLEL,
        .failed = CATCHES_FINISHED,
        .where = "commstime.csp:74",
        .offset = offsetof(struct commstime, parallel)
    },
    [CATCHES_FINISHED] = {
        .waiting = CSP_AT_NOTHING,
        .failed = CATCHES_FINISHED,
        .where = "commstime.csp:74"
    }
};

static const csp_class commstime_class = {
    .step = commstime_step,
    .places = commstime_places,
    .name = "Commstime",
    .where = "commstime.csp:60",
    .offset = 0,
    .states = CSP_STATES(commstime_places)
};

void commstime_initialize(struct commstime *self, csp_numbers *numbers, int64_t rounds)
{
    csp_process_init(&self->process, &commstime_class, numbers->process);
    numbers->process++;
    csp_channel_init(&self->a, numbers->channel);
    numbers->channel++;
    csp_channel_init(&self->b, numbers->channel);
    numbers->channel++;
    csp_channel_init(&self->c, numbers->channel);
    numbers->channel++;
    csp_channel_init(&self->d, numbers->channel);
    numbers->channel++;
    prefix_initialize(&self->prefix, numbers,
        &(const struct prefix_ports){.input = &self->d, .output = &self->a}, 0);
    delta_initialize(&self->delta, numbers,
        &(const struct delta_ports){.input = &self->a, .first = &self->b, .second = &self->c});
    successor_initialize(&self->successor, numbers,
        &(const struct successor_ports){.input = &self->c, .output = &self->d});
    consumer_initialize(&self->consumer, numbers, &(const struct consumer_ports){.input = &self->b},
        rounds);
}
