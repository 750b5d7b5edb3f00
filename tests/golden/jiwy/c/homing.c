/* SPDX-License-Identifier: 0BSD */
#include "homing.h"

#include "csp_arithmetic.h"

/* Where the process waits, and where it continues after a failure. */
enum {
    INTERRUPTIBLE_REPEAT_SERVO = 1,
    CATCHES_TIMEOUT,
    REPEAT_SERVO_READS_FEEDBACK,
    REPEAT_SERVO_FAILS
};

static csp_party *homing_repeat_servo_step(csp_kernel *csp, csp_party *party)
{
    struct homing *const self = CSP_ENCLOSING(party, struct homing, repeat_servo_branch);
    csp_progress progress;

    switch (party->state) {
    case 0:
        do {
            /* servo (jiwy.csp:97) */
            csp_require_written(csp, self->leftmax_written);
            if (csp_raised_in(csp, party, "servo", "laws.csp:56")) {
                goto fails;
            }
            self->servo.leftmax = *self->leftmax;
            csp_require_written(csp, self->rightmax_written);
            if (csp_raised_in(csp, party, "servo", "laws.csp:56")) {
                goto fails;
            }
            self->servo.rightmax = *self->rightmax;
            self->servo.setpoint = self->zero;
            CSP_AWAIT(csp_sampled_read(csp, party, &self->feedback, &self->servo.feedback,
                    sizeof(self->servo.feedback)),
                csp_sampled_read_again(csp, party, &self->feedback, &self->servo.feedback,
                    sizeof(self->servo.feedback)),
                REPEAT_SERVO_READS_FEEDBACK, fails)
            position_controller_calculate(csp, &self->servo);
            if (csp_raised_in(csp, party, "servo", "laws.csp:56")) {
                goto fails;
            }
            if (csp_refused(csp, party)) {
                goto fails;
            }
            (void)csp_latched_write(party, self->control, &self->servo.control,
                sizeof(self->servo.control));
            self->reference = self->servo.reference;
            self->stop = self->servo.stop;
        } while (!self->stop);
        return csp_end(csp, party);
    case REPEAT_SERVO_FAILS:
    fails:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place homing_repeat_servo_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "jiwy.csp:76"},
    [REPEAT_SERVO_READS_FEEDBACK] = {
        .waiting = CSP_AT_READ,
        .failed = REPEAT_SERVO_FAILS,
        .where = "laws.csp:56",
        .inner = "servo",
        .offset = offsetof(struct homing, feedback)
    },
    [REPEAT_SERVO_FAILS] = {
        .waiting = CSP_AT_NOTHING,
        .failed = REPEAT_SERVO_FAILS,
        .where = "jiwy.csp:76"
    }
};

static const csp_class homing_repeat_servo_class = {
    .step = homing_repeat_servo_step,
    .places = homing_repeat_servo_places,
    .name = "Homing",
    .where = "jiwy.csp:76",
    .offset = offsetof(struct homing, repeat_servo_branch),
    .states = CSP_STATES(homing_repeat_servo_places)
};

static csp_party *homing_step(csp_kernel *csp, csp_party *party)
{
    struct homing *const self = CSP_ENCLOSING(party, struct homing, process);
    csp_progress progress;

    switch (party->state) {
    case 0:
        csp_observe_begin(csp, party->number);
        /* (mu servo until stop) interrupt after patience -> skip (jiwy.csp:97) */
        csp_interrupt_prepare(&self->interrupt_repeat_servo);
        csp_guard_after(&self->interrupt_repeat_servo.alternative, 0U,
            &self->interrupt_repeat_servo.timer);
        csp_delay(&self->interrupt_repeat_servo.alternative, 0U, self->patience);
        CSP_AWAIT(csp_interruptible(csp, party, &self->interrupt_repeat_servo),
            csp_interruptible_again(csp, party, &self->interrupt_repeat_servo),
            INTERRUPTIBLE_REPEAT_SERVO, catches_timeout)
        /* after patience (jiwy.csp:97) */
        goto after_catches_timeout;
    case CATCHES_TIMEOUT:
    catches_timeout:
        csp_unwind(csp, party);
        if (!csp_catch(csp, CSP_TIMEOUT_EXCEPTION)) {
            goto fails;
        }
        /* failed := true (jiwy.csp:97) */
        self->failed = true;
    after_catches_timeout:
        /* control ! 0<V> (jiwy.csp:98) */
        self->sent.control = 0.0;
        if (csp_refused(csp, party)) {
            goto fails;
        }
        (void)csp_latched_write(party, self->control, &self->sent.control,
            sizeof(self->sent.control));
        if (self->failed) {
            /* raise ModeFailed (jiwy.csp:99) */
            (void)csp_raise(csp, party, EXCEPTION_MODE_FAILED, "jiwy.csp:99");
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

static const csp_place homing_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "jiwy.csp:76"},
    [INTERRUPTIBLE_REPEAT_SERVO] = {
        .waiting = CSP_AT_INTERRUPT,
        .failed = CATCHES_TIMEOUT,
        .where = "jiwy.csp:97",
        .offset = offsetof(struct homing, interrupt_repeat_servo)
    },
    [CATCHES_TIMEOUT] = {
        .waiting = CSP_AT_NOTHING,
        .failed = CATCHES_TIMEOUT,
        .where = "jiwy.csp:97"
    }
};

static const csp_class homing_class = {
    .step = homing_step,
    .places = homing_places,
    .name = "Homing",
    .where = "jiwy.csp:76",
    .offset = 0,
    .states = CSP_STATES(homing_places)
};

void homing_initialize(struct homing *self, csp_numbers *numbers, const struct homing_ports *ports,
    int64_t T, const struct jiwy_servo_gains *gains, int64_t patience)
{
    csp_process_init(&self->process, &homing_class, numbers->process);
    numbers->process++;
    self->patience = patience;
    self->leftmax = ports->leftmax;
    self->leftmax_written = ports->leftmax_written;
    self->rightmax = ports->rightmax;
    self->rightmax_written = ports->rightmax_written;
    self->control = ports->control;
    self->zero = 0.0;
    self->failed = false;
    csp_sampled_end_init(&self->feedback, ports->feedback, &self->samples);
    position_controller_initialize(&self->servo, gains, 0.0, 6.0, 50 * CSP_MS, 100 * CSP_MS, 0.05,
        csp_seconds(T));
    csp_process_init(&self->repeat_servo_branch, &homing_repeat_servo_class,
        self->process.party.number);
    csp_interrupt_init(&self->interrupt_repeat_servo,
        (uint32_t)offsetof(struct homing, repeat_servo_branch));
}
