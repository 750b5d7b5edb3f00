/* SPDX-License-Identifier: 0BSD */
#include "jiwy.h"

#include "constants.h"

/* Where the process waits, and where it continues after a failure. */
enum {
    IN_PARALLEL = 1,
    FAILS
};

static const csp_branches jiwy_branches[] = {
    {.offset = offsetof(struct jiwy, horizontal.process), .stride = 0U, .count = 1U, .level = 0U},
    {.offset = offsetof(struct jiwy, vertical.process), .stride = 0U, .count = 1U, .level = 0U}
};

static csp_party *jiwy_step(csp_kernel *csp, csp_party *party)
{
    struct jiwy *const self = CSP_ENCLOSING(party, struct jiwy, process);
    csp_progress progress;

    switch (party->state) {
    case 0:
        csp_observe_begin(csp, party->number);
        /* horizontal || vertical (jiwy.csp:157) */
        CSP_AWAIT(csp_par(csp, party, &self->parallel, jiwy_branches, 2U),
            csp_par_again(csp, party, &self->parallel), IN_PARALLEL, fails)
        csp_observe_end(csp, party->number);
        return csp_end(csp, party);
    case FAILS:
    fails:
        csp_unwind(csp, party);
        csp_observe_end(csp, party->number);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place jiwy_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "jiwy.csp:134"},
    [IN_PARALLEL] = {
        .waiting = CSP_AT_PARALLEL,
        .failed = FAILS,
        .where = "jiwy.csp:157",
        .offset = offsetof(struct jiwy, parallel)
    },
    [FAILS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "jiwy.csp:134"}
};

static const csp_class jiwy_class = {
    .step = jiwy_step,
    .places = jiwy_places,
    .name = "Jiwy",
    .where = "jiwy.csp:134",
    .offset = 0,
    .states = CSP_STATES(jiwy_places)
};

void jiwy_initialize(struct jiwy *self, csp_numbers *numbers, const struct jiwy_ports *ports,
    const struct jiwy_servo_gains *panGains, const struct jiwy_servo_gains *tiltGains)
{
    csp_process_init(&self->process, &jiwy_class, numbers->process);
    numbers->process++;
    joint_control_initialize(&self->horizontal, numbers,
        &(const struct joint_control_ports){
            .feedback = ports->feedback_horizontal,
            .joystick_axis = ports->joystick_horizontal,
            .joystick_buttons = ports->joystick_buttons,
            .control = ports->control_horizontal
        },
        Tsh, panGains, 0.3);
    joint_control_initialize(&self->vertical, numbers,
        &(const struct joint_control_ports){
            .feedback = ports->feedback_vertical,
            .joystick_axis = ports->joystick_vertical,
            .joystick_buttons = ports->joystick_buttons,
            .control = ports->control_vertical
        },
        Tsv, tiltGains, 0.11);
}
