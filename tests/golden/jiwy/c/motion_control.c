/* SPDX-License-Identifier: 0BSD */
#include "motion_control.h"

#include "csp_arithmetic.h"
#include "constants.h"

/* Where the process waits, and where it continues after a failure. */
enum {
    CHOOSES = 1,
    READS_SERVO,
    CATCHES_TIMEOUT
};

static csp_party *motion_control_step(csp_kernel *csp, csp_party *party)
{
    struct motion_control *const self = CSP_ENCLOSING(party, struct motion_control, process);
    csp_progress progress;

    switch (party->state) {
    case 0:
        csp_observe_begin(csp, party->number);
        do {
            /* joystick_buttons ? status -> skip []> feedback -> servo (jiwy.csp:68) */
            CSP_AWAIT(csp_select(csp, party, &self->choice.alternative),
                csp_select_again(csp, party, &self->choice.alternative), CHOOSES, catches_timeout)
            if (self->choice.alternative.chosen != 0U) {
                /* feedback (jiwy.csp:68) */
                /* servo (jiwy.csp:68) */
                if (csp_offers_begin(csp, party, &self->offers) == CSP_FAILS) {
                    goto catches_timeout;
                }
                csp_require_written(csp, self->leftmax_written);
                if (csp_raised_in(csp, party, "servo", "laws.csp:56")) {
                    csp_offers_give_up(csp, &self->offers);
                    goto catches_timeout;
                }
                self->servo.leftmax = *self->leftmax;
                csp_require_written(csp, self->rightmax_written);
                if (csp_raised_in(csp, party, "servo", "laws.csp:56")) {
                    csp_offers_give_up(csp, &self->offers);
                    goto catches_timeout;
                }
                self->servo.rightmax = *self->rightmax;
                if (CSP_OFFER(&self->offers, csp_sampled_read, &self->feedback,
                            self->servo.feedback)
                        == CSP_FAILS) {
                    party->state = (uint16_t)READS_SERVO;
                    goto catches_timeout;
                }
                if (CSP_OFFER(&self->offers, csp_sampled_read, &self->joystick_axis,
                            self->servo.setpoint)
                        == CSP_FAILS) {
                    party->state = (uint16_t)READS_SERVO;
                    goto catches_timeout;
                }
                CSP_AWAIT(csp_offers_wait(&self->offers), csp_offers_again(party, &self->offers),
                    READS_SERVO, catches_timeout)
                position_controller_calculate(csp, &self->servo);
                if (csp_raised_in(csp, party, "servo", "laws.csp:56")) {
                    goto catches_timeout;
                }
                if (csp_refused(csp, party)) {
                    goto catches_timeout;
                }
                (void)csp_latched_write(party, self->control, &self->servo.control,
                    sizeof(self->servo.control));
                self->reference = self->servo.reference;
            }
        } while (self->status != stopButton);
        goto after_catches_timeout;
    case CATCHES_TIMEOUT:
    catches_timeout:
        csp_unwind(csp, party);
        if (!csp_catch(csp, CSP_TIMEOUT_EXCEPTION)) {
            goto fails;
        }
        /* failed := true (jiwy.csp:69) */
        self->failed = true;
    after_catches_timeout:
        /* control ! 0<V> (jiwy.csp:70) */
        self->sent.control = 0.0;
        if (csp_refused(csp, party)) {
            goto fails;
        }
        (void)csp_latched_write(party, self->control, &self->sent.control,
            sizeof(self->sent.control));
        if (self->failed) {
            /* raise ModeFailed (jiwy.csp:71) */
            (void)csp_raise(csp, party, EXCEPTION_MODE_FAILED, "jiwy.csp:71");
            goto fails;
        }
        csp_ends_close(&self->samples);
        csp_observe_end(csp, party->number);
        return csp_end(csp, party);
    fails:
        csp_unwind(csp, party);
        csp_ends_close(&self->samples);
        csp_observe_end(csp, party->number);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place motion_control_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "jiwy.csp:46"},
    [CHOOSES] = {
        .waiting = CSP_AT_ALTERNATIVE,
        .failed = CATCHES_TIMEOUT,
        .where = "jiwy.csp:68",
        .offset = offsetof(struct motion_control, choice.alternative)
    },
    [READS_SERVO] = {
        .waiting = CSP_AT_INPUTS,
        .failed = CATCHES_TIMEOUT,
        .where = "laws.csp:56",
        .inner = "servo",
        .offset = offsetof(struct motion_control, offers)
    },
    [CATCHES_TIMEOUT] = {
        .waiting = CSP_AT_NOTHING,
        .failed = CATCHES_TIMEOUT,
        .where = "jiwy.csp:68"
    }
};

static const csp_class motion_control_class = {
    .step = motion_control_step,
    .places = motion_control_places,
    .name = "MotionControl",
    .where = "jiwy.csp:46",
    .offset = 0,
    .states = CSP_STATES(motion_control_places)
};

void motion_control_initialize(struct motion_control *self, csp_numbers *numbers,
    const struct motion_control_ports *ports, int64_t T, const struct jiwy_servo_gains *gains,
    double reach)
{
    csp_process_init(&self->process, &motion_control_class, numbers->process);
    numbers->process++;
    self->leftmax = ports->leftmax;
    self->leftmax_written = ports->leftmax_written;
    self->rightmax = ports->rightmax;
    self->rightmax_written = ports->rightmax_written;
    self->control = ports->control;
    self->status = 0;
    self->failed = false;
    csp_offers_init(&self->offers, self->offers_made, 2U);
    self->joystick_buttons =
        csp_event_reader(&self->joystick_buttons_latch, ports->joystick_buttons);
    csp_sampled_end_init(&self->feedback, ports->feedback, &self->samples);
    csp_sampled_end_init(&self->joystick_axis, ports->joystick_axis, &self->samples);
    position_controller_initialize(&self->servo, gains, reach, 6.0, 50 * CSP_MS, 100 * CSP_MS, 0.05,
        csp_seconds(T));
    csp_alternative_init(&self->choice.alternative, self->choice.guards, 2U, NULL, true);
    csp_guard_read(&self->choice.alternative, 0U, &self->joystick_buttons->medium, &self->status,
        sizeof(self->status));
    csp_guard_ready(&self->choice.alternative, 1U, &self->feedback.medium);
    csp_enable_all(&self->choice.alternative);
}
