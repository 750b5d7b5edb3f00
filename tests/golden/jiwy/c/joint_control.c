/* SPDX-License-Identifier: 0BSD */
#include "joint_control.h"

#include "csp_arithmetic.h"

/* Where the process waits, and where it continues after a failure. */
enum {
    RUNS_ALIGN_L = 1,
    RUNS_ALIGN_R,
    RUNS_MOTION_CONTROL,
    RUNS_HOMING,
    FAILS
};

static csp_party *joint_control_step(csp_kernel *csp, csp_party *party)
{
    struct joint_control *const self = CSP_ENCLOSING(party, struct joint_control, process);

    switch (party->state) {
    case 0:
        csp_observe_begin(csp, party->number);
        /* alignL (jiwy.csp:129) */
        party->state = (uint16_t)RUNS_ALIGN_L;
        return csp_call(party, &self->alignL.process);
    case RUNS_ALIGN_L:
        /* alignR (jiwy.csp:129) */
        party->state = (uint16_t)RUNS_ALIGN_R;
        return csp_call(party, &self->alignR.process);
    case RUNS_ALIGN_R:
        /* motionControl (jiwy.csp:129) */
        party->state = (uint16_t)RUNS_MOTION_CONTROL;
        return csp_call(party, &self->motionControl.process);
    case RUNS_MOTION_CONTROL:
        /* homing (jiwy.csp:129) */
        party->state = (uint16_t)RUNS_HOMING;
        return csp_call(party, &self->homing.process);
    case RUNS_HOMING:
        csp_observe_end(csp, party->number);
        return csp_end(csp, party);
    case FAILS:
        csp_unwind(csp, party);
        csp_observe_end(csp, party->number);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place joint_control_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "jiwy.csp:104"},
    [RUNS_ALIGN_L] = {
        .waiting = CSP_AT_CALL,
        .failed = FAILS,
        .where = "jiwy.csp:129",
        .offset = offsetof(struct joint_control, alignL)
    },
    [RUNS_ALIGN_R] = {
        .waiting = CSP_AT_CALL,
        .failed = FAILS,
        .where = "jiwy.csp:129",
        .offset = offsetof(struct joint_control, alignR)
    },
    [RUNS_MOTION_CONTROL] = {
        .waiting = CSP_AT_CALL,
        .failed = FAILS,
        .where = "jiwy.csp:129",
        .offset = offsetof(struct joint_control, motionControl)
    },
    [RUNS_HOMING] = {
        .waiting = CSP_AT_CALL,
        .failed = FAILS,
        .where = "jiwy.csp:129",
        .offset = offsetof(struct joint_control, homing)
    },
    [FAILS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "jiwy.csp:104"}
};

static const csp_class joint_control_class = {
    .step = joint_control_step,
    .places = joint_control_places,
    .name = "JointControl",
    .where = "jiwy.csp:104",
    .offset = 0,
    .states = CSP_STATES(joint_control_places)
};

void joint_control_initialize(struct joint_control *self, csp_numbers *numbers,
    const struct joint_control_ports *ports, int64_t T, const struct jiwy_servo_gains *gains,
    double reach, double alignSpeed, double alignKp, double alignKi)
{
    csp_process_init(&self->process, &joint_control_class, numbers->process);
    numbers->process++;
    self->leftmax_written.number = numbers->variable;
    numbers->variable++;
    self->rightmax_written.number = numbers->variable;
    numbers->variable++;
    align_initialize(&self->alignL, numbers,
        &(const struct align_ports){
            .feedback = ports->feedback,
            .control = ports->control,
            .max = &self->leftmax,
            .max_written = &self->leftmax_written
        },
        T, -alignSpeed, alignKp, alignKi, 10 * CSP_S);
    align_initialize(&self->alignR, numbers,
        &(const struct align_ports){
            .feedback = ports->feedback,
            .control = ports->control,
            .max = &self->rightmax,
            .max_written = &self->rightmax_written
        },
        T, alignSpeed, alignKp, alignKi, 10 * CSP_S);
    motion_control_initialize(&self->motionControl, numbers,
        &(const struct motion_control_ports){
            .leftmax = &self->leftmax,
            .leftmax_written = &self->leftmax_written,
            .rightmax = &self->rightmax,
            .rightmax_written = &self->rightmax_written,
            .feedback = ports->feedback,
            .joystick_axis = ports->joystick_axis,
            .joystick_buttons = ports->joystick_buttons,
            .control = ports->control
        },
        T, gains, reach);
    homing_initialize(&self->homing, numbers,
        &(const struct homing_ports){
            .leftmax = &self->leftmax,
            .leftmax_written = &self->leftmax_written,
            .rightmax = &self->rightmax,
            .rightmax_written = &self->rightmax_written,
            .feedback = ports->feedback,
            .control = ports->control
        },
        T, gains, 3 * CSP_S);
}
