/* SPDX-License-Identifier: 0BSD */
#include "joint_control.h"

#include "csp_arithmetic.h"
#include "constants.h"

/* Where the process waits, and where it continues after a failure. */
enum {
    ALIGN_L_INTERRUPTIBLE_RUN_VELOCITY = 1,
    ALIGN_L_CATCHES_TIMEOUT,
    ALIGN_R_INTERRUPTIBLE_RUN_VELOCITY,
    ALIGN_R_CATCHES_TIMEOUT,
    MOTION_CONTROL_CHOOSES,
    MOTION_CONTROL_READS_INPUTS,
    MOTION_CONTROL_CATCHES_TIMEOUT,
    HOMING_INTERRUPTIBLE_RUN_SERVO,
    HOMING_CATCHES_TIMEOUT,
    ALIGN_L_BEGINS,
    ALIGN_R_BEGINS,
    MOTION_CONTROL_BEGINS,
    HOMING_BEGINS,
    JOINT_CONTROL_ENDS,
    FAILS,
    ALIGN_L_RUN_VELOCITY_READS_FEEDBACK,
    ALIGN_L_RUN_VELOCITY_FAILS,
    ALIGN_R_RUN_VELOCITY_READS_FEEDBACK,
    ALIGN_R_RUN_VELOCITY_FAILS,
    HOMING_RUN_SERVO_READS_FEEDBACK,
    HOMING_RUN_SERVO_FAILS
};

/* alignL.velocity: Constant speed: PI on the filtered difference of the encoder, its output
 * limited, so that it presses gently on the end stop. The end stop is the joint standing still
 * for `dwell` although the controller drives with more than `effort`; `max` is where the joint
 * is. (jiwy.csp:39)
 */
static void joint_control_align_l_velocity_calculate(csp_kernel *csp, struct joint_control *self)
{
    /* laws.csp:103 */
    const double difference = self->alignL_velocity_moving
        ? csp_divide(csp, self->alignL_velocity_feedback - self->alignL_velocity_last,
            self->alignL_velocity_sample)
        : 0.0;
    if (csp_faulted_at(csp, "laws.csp:103")) {
        return;
    }
    /* laws.csp:104 */
    const double velocity = self->alignL_velocity_filtered
        + csp_divide(csp, self->alignL_velocity_sample, 0.02 + self->alignL_velocity_sample)
            * (difference - self->alignL_velocity_filtered);
    if (csp_faulted_at(csp, "laws.csp:104")) {
        return;
    }
    const double error = -1.0 - velocity; /* laws.csp:105 */
    /* laws.csp:106 */
    const double i = self->alignL_velocity_ui + self->alignL_velocity_sample * 2.2 * error;
    const double sum = self->alignKp * error + i; /* laws.csp:107 */
    self->alignL_velocity_control = csp_limit(sum, -1.5, 1.5); /* laws.csp:109 */
    /* laws.csp:115 */
    const bool pressing = (fabs(velocity) < 0.1) && (-self->alignL_velocity_control > 0.9);
    /* laws.csp:116 */
    const double held =
        pressing ? self->alignL_velocity_pressed + self->alignL_velocity_sample : 0.0;
    self->alignL_velocity_stop = held >= 0.1; /* laws.csp:118 */
    const double filtered_next = velocity; /* laws.csp:112 */
    /* laws.csp:113 */
    const double ui_next = (sum == self->alignL_velocity_control) ? i : self->alignL_velocity_ui;
    const double pressed_next = held; /* laws.csp:117 */
    /* A sum is finite only if its terms are. */
    if (!csp_is_finite(self->alignL_velocity_control + filtered_next + ui_next + pressed_next)) {
        csp_finite_at(csp, self->alignL_velocity_control, "laws.csp:109");
        csp_finite_at(csp, filtered_next, "laws.csp:112");
        csp_finite_at(csp, ui_next, "laws.csp:113");
        csp_finite_at(csp, pressed_next, "laws.csp:117");
        if (csp_faulted_at(csp, "laws.csp:117")) {
            return;
        }
    }
    self->alignL_velocity_moving = true; /* laws.csp:110 */
    self->alignL_velocity_last = self->alignL_velocity_feedback; /* laws.csp:111 */
    self->alignL_velocity_filtered = filtered_next; /* laws.csp:112 */
    self->alignL_velocity_ui = ui_next; /* laws.csp:113 */
    self->alignL_velocity_pressed = pressed_next; /* laws.csp:117 */
}

/* alignR.velocity: Constant speed: PI on the filtered difference of the encoder, its output
 * limited, so that it presses gently on the end stop. The end stop is the joint standing still
 * for `dwell` although the controller drives with more than `effort`; `max` is where the joint
 * is. (jiwy.csp:39)
 */
static void joint_control_align_r_velocity_calculate(csp_kernel *csp, struct joint_control *self)
{
    /* laws.csp:103 */
    const double difference = self->alignR_velocity_moving
        ? csp_divide(csp, self->alignR_velocity_feedback - self->alignR_velocity_last,
            self->alignR_velocity_sample)
        : 0.0;
    if (csp_faulted_at(csp, "laws.csp:103")) {
        return;
    }
    /* laws.csp:104 */
    const double velocity = self->alignR_velocity_filtered
        + csp_divide(csp, self->alignR_velocity_sample, 0.02 + self->alignR_velocity_sample)
            * (difference - self->alignR_velocity_filtered);
    if (csp_faulted_at(csp, "laws.csp:104")) {
        return;
    }
    const double error = 1.0 - velocity; /* laws.csp:105 */
    /* laws.csp:106 */
    const double i = self->alignR_velocity_ui + self->alignR_velocity_sample * 2.2 * error;
    const double sum = self->alignKp * error + i; /* laws.csp:107 */
    self->alignR_velocity_control = csp_limit(sum, -1.5, 1.5); /* laws.csp:109 */
    /* laws.csp:115 */
    const bool pressing = (fabs(velocity) < 0.1) && (self->alignR_velocity_control > 0.9);
    /* laws.csp:116 */
    const double held =
        pressing ? self->alignR_velocity_pressed + self->alignR_velocity_sample : 0.0;
    self->alignR_velocity_stop = held >= 0.1; /* laws.csp:118 */
    const double filtered_next = velocity; /* laws.csp:112 */
    /* laws.csp:113 */
    const double ui_next = (sum == self->alignR_velocity_control) ? i : self->alignR_velocity_ui;
    const double pressed_next = held; /* laws.csp:117 */
    /* A sum is finite only if its terms are. */
    if (!csp_is_finite(self->alignR_velocity_control + filtered_next + ui_next + pressed_next)) {
        csp_finite_at(csp, self->alignR_velocity_control, "laws.csp:109");
        csp_finite_at(csp, filtered_next, "laws.csp:112");
        csp_finite_at(csp, ui_next, "laws.csp:113");
        csp_finite_at(csp, pressed_next, "laws.csp:117");
        if (csp_faulted_at(csp, "laws.csp:117")) {
            return;
        }
    }
    self->alignR_velocity_moving = true; /* laws.csp:110 */
    self->alignR_velocity_last = self->alignR_velocity_feedback; /* laws.csp:111 */
    self->alignR_velocity_filtered = filtered_next; /* laws.csp:112 */
    self->alignR_velocity_ui = ui_next; /* laws.csp:113 */
    self->alignR_velocity_pressed = pressed_next; /* laws.csp:117 */
}

/* motionControl.servo: Position servo of one joint. The set-point counts from the centre between
 * the end stops, 1 being `reach`; `reference` is the angle that this means. The voltage for the
 * friction is added in the direction in which the profile moves. `stop` tells that the joint has
 * stood where it should for `dwell`. (jiwy.csp:68)
 */
static void joint_control_motion_control_servo_calculate(csp_kernel *csp,
    struct joint_control *self)
{
    const double pid_beta = self->gains->beta; /* laws.csp:6 */
    const double pid_kp = self->gains->kp; /* laws.csp:6 */
    /* What follows from parameters, again after a change of one. */
    if (self->motionControl_servo_changes != csp->changes) {
        const double pid_tauD = csp_seconds(self->gains->tauD); /* laws.csp:6 */
        /* laws.csp:14 */
        self->motionControl_servo_pid_f =
            csp_divide(csp, 1.0, self->motionControl_servo_sample + pid_tauD * pid_beta);
        if (csp_faulted_at(csp, "laws.csp:14")) {
            return;
        }
        self->motionControl_servo_pid_tauI = csp_seconds(self->gains->tauI); /* laws.csp:6 */
        /* jiwy.csp:68 */
        self->motionControl_servo_sample_kp = self->motionControl_servo_sample * pid_kp;
        self->motionControl_servo_tauD_kp = pid_tauD * pid_kp; /* jiwy.csp:68 */
        self->motionControl_servo_tauD_beta = pid_tauD * pid_beta; /* jiwy.csp:68 */
        self->motionControl_servo_changes = csp->changes;
    }
    /* laws.csp:71 */
    const double centre =
        (self->motionControl_servo_leftmax + self->motionControl_servo_rightmax) / 2.0;
    /* laws.csp:72 */
    self->motionControl_servo_reference = csp_real(csp,
        csp_limit(centre + 1.25 * self->motionControl_servo_setpoint,
            self->motionControl_servo_leftmax + 0.05, self->motionControl_servo_rightmax - 0.05));
    if (csp_faulted_at(csp, "laws.csp:72")) {
        return;
    }
    /* laws.csp:35 */
    const double profile_from = self->motionControl_servo_profile_moving
        ? self->motionControl_servo_profile_last
        : self->motionControl_servo_feedback;
    /* laws.csp:36 */
    const double profile_velocity =
        csp_limit((self->motionControl_servo_reference - profile_from) / 0.05, -6.0, 6.0);
    /* laws.csp:37 */
    const double profile_angle = profile_from + self->motionControl_servo_sample * profile_velocity;
    const double pid_error = profile_angle - self->motionControl_servo_feedback; /* laws.csp:75 */
    /* laws.csp:15 */
    const double pid_d = self->motionControl_servo_pid_f
        * (self->motionControl_servo_tauD_beta * self->motionControl_servo_pid_ud
            + self->motionControl_servo_tauD_kp * (pid_error - self->motionControl_servo_pid_e1)
            + self->motionControl_servo_sample_kp * pid_error);
    /* laws.csp:16 */
    const double pid_i = self->motionControl_servo_pid_ui
        + csp_divide(csp, self->motionControl_servo_sample * pid_d,
            self->motionControl_servo_pid_tauI);
    if (csp_faulted_at(csp, "laws.csp:16")) {
        return;
    }
    const double pid_sum = pid_i + pid_d; /* laws.csp:17 */
    const double pid_output = csp_limit(pid_sum, -0.99, 0.99); /* laws.csp:19 */
    /* laws.csp:77 */
    const double assistance = self->gains->friction * csp_limit(profile_velocity / 0.05, -1.0, 1.0);
    /* laws.csp:78 */
    self->motionControl_servo_control = csp_limit(supply * pid_output + assistance, -12.0, supply);
    /* laws.csp:80 */
    const double standing = (fabs(
                self->motionControl_servo_reference - self->motionControl_servo_feedback)
            < self->gains->tolerance)
        ? self->motionControl_servo_arrived + self->motionControl_servo_sample
        : 0.0;
    const double profile_last_next = profile_angle; /* laws.csp:39 */
    const double pid_e1_next = pid_error; /* laws.csp:20 */
    const double pid_ud_next = pid_d; /* laws.csp:21 */
    /* laws.csp:22 */
    const double pid_ui_next = (pid_sum == pid_output) ? pid_i : self->motionControl_servo_pid_ui;
    const double arrived_next = standing; /* laws.csp:81 */
    /* A sum is finite only if its terms are. */
    if (!csp_is_finite(
            self->motionControl_servo_control
                + profile_last_next
                + pid_e1_next
                + pid_ud_next
                + pid_ui_next
                + arrived_next)) {
        csp_finite_at(csp, self->motionControl_servo_control, "laws.csp:78");
        csp_finite_at(csp, profile_last_next, "laws.csp:39");
        csp_finite_at(csp, pid_e1_next, "laws.csp:20");
        csp_finite_at(csp, pid_ud_next, "laws.csp:21");
        csp_finite_at(csp, pid_ui_next, "laws.csp:22");
        csp_finite_at(csp, arrived_next, "laws.csp:81");
        if (csp_faulted_at(csp, "laws.csp:81")) {
            return;
        }
    }
    self->motionControl_servo_profile_moving = true; /* laws.csp:38 */
    self->motionControl_servo_profile_last = profile_last_next; /* laws.csp:39 */
    self->motionControl_servo_pid_e1 = pid_e1_next; /* laws.csp:20 */
    self->motionControl_servo_pid_ud = pid_ud_next; /* laws.csp:21 */
    self->motionControl_servo_pid_ui = pid_ui_next; /* laws.csp:22 */
    self->motionControl_servo_arrived = arrived_next; /* laws.csp:81 */
}

/* homing.servo: Position servo of one joint. The set-point counts from the centre between the
 * end stops, 1 being `reach`; `reference` is the angle that this means. The voltage for the
 * friction is added in the direction in which the profile moves. `stop` tells that the joint has
 * stood where it should for `dwell`. (jiwy.csp:97)
 */
static void joint_control_homing_servo_calculate(csp_kernel *csp, struct joint_control *self)
{
    const double pid_beta = self->gains->beta; /* laws.csp:6 */
    const double pid_kp = self->gains->kp; /* laws.csp:6 */
    /* What follows from parameters, again after a change of one. */
    if (self->homing_servo_changes != csp->changes) {
        const double pid_tauD = csp_seconds(self->gains->tauD); /* laws.csp:6 */
        /* laws.csp:14 */
        self->homing_servo_pid_f =
            csp_divide(csp, 1.0, self->homing_servo_sample + pid_tauD * pid_beta);
        if (csp_faulted_at(csp, "laws.csp:14")) {
            return;
        }
        self->homing_servo_pid_tauI = csp_seconds(self->gains->tauI); /* laws.csp:6 */
        self->homing_servo_sample_kp = self->homing_servo_sample * pid_kp; /* jiwy.csp:97 */
        self->homing_servo_tauD_kp = pid_tauD * pid_kp; /* jiwy.csp:97 */
        self->homing_servo_tauD_beta = pid_tauD * pid_beta; /* jiwy.csp:97 */
        self->homing_servo_changes = csp->changes;
    }
    /* laws.csp:71 */
    const double centre = (self->homing_servo_leftmax + self->homing_servo_rightmax) / 2.0;
    /* laws.csp:72 */
    self->homing_servo_reference = csp_real(csp,
        csp_limit(csp_positive_zero(centre), self->homing_servo_leftmax + 0.05,
            self->homing_servo_rightmax - 0.05));
    if (csp_faulted_at(csp, "laws.csp:72")) {
        return;
    }
    /* laws.csp:35 */
    const double profile_from = self->homing_servo_profile_moving
        ? self->homing_servo_profile_last
        : self->homing_servo_feedback;
    /* laws.csp:36 */
    const double profile_velocity =
        csp_limit((self->homing_servo_reference - profile_from) / 0.05, -6.0, 6.0);
    /* laws.csp:37 */
    const double profile_angle = profile_from + self->homing_servo_sample * profile_velocity;
    const double pid_error = profile_angle - self->homing_servo_feedback; /* laws.csp:75 */
    /* laws.csp:15 */
    const double pid_d = self->homing_servo_pid_f
        * (self->homing_servo_tauD_beta * self->homing_servo_pid_ud
            + self->homing_servo_tauD_kp * (pid_error - self->homing_servo_pid_e1)
            + self->homing_servo_sample_kp * pid_error);
    /* laws.csp:16 */
    const double pid_i = self->homing_servo_pid_ui
        + csp_divide(csp, self->homing_servo_sample * pid_d, self->homing_servo_pid_tauI);
    if (csp_faulted_at(csp, "laws.csp:16")) {
        return;
    }
    const double pid_sum = pid_i + pid_d; /* laws.csp:17 */
    const double pid_output = csp_limit(pid_sum, -0.99, 0.99); /* laws.csp:19 */
    /* laws.csp:77 */
    const double assistance = self->gains->friction * csp_limit(profile_velocity / 0.05, -1.0, 1.0);
    /* laws.csp:78 */
    self->homing_servo_control = csp_limit(supply * pid_output + assistance, -12.0, supply);
    /* laws.csp:80 */
    const double standing =
        (fabs(self->homing_servo_reference - self->homing_servo_feedback) < self->gains->tolerance)
            ? self->homing_servo_arrived + self->homing_servo_sample
            : 0.0;
    self->homing_servo_stop = standing >= 0.1; /* laws.csp:82 */
    const double profile_last_next = profile_angle; /* laws.csp:39 */
    const double pid_e1_next = pid_error; /* laws.csp:20 */
    const double pid_ud_next = pid_d; /* laws.csp:21 */
    /* laws.csp:22 */
    const double pid_ui_next = (pid_sum == pid_output) ? pid_i : self->homing_servo_pid_ui;
    const double arrived_next = standing; /* laws.csp:81 */
    /* A sum is finite only if its terms are. */
    if (!csp_is_finite(
            self->homing_servo_control
                + profile_last_next
                + pid_e1_next
                + pid_ud_next
                + pid_ui_next
                + arrived_next)) {
        csp_finite_at(csp, self->homing_servo_control, "laws.csp:78");
        csp_finite_at(csp, profile_last_next, "laws.csp:39");
        csp_finite_at(csp, pid_e1_next, "laws.csp:20");
        csp_finite_at(csp, pid_ud_next, "laws.csp:21");
        csp_finite_at(csp, pid_ui_next, "laws.csp:22");
        csp_finite_at(csp, arrived_next, "laws.csp:81");
        if (csp_faulted_at(csp, "laws.csp:81")) {
            return;
        }
    }
    self->homing_servo_profile_moving = true; /* laws.csp:38 */
    self->homing_servo_profile_last = profile_last_next; /* laws.csp:39 */
    self->homing_servo_pid_e1 = pid_e1_next; /* laws.csp:20 */
    self->homing_servo_pid_ud = pid_ud_next; /* laws.csp:21 */
    self->homing_servo_pid_ui = pid_ui_next; /* laws.csp:22 */
    self->homing_servo_arrived = arrived_next; /* laws.csp:81 */
}

static csp_party *joint_control_homing_run_servo_step(csp_kernel *csp, csp_party *party)
{
    struct joint_control *const self =
        CSP_ENCLOSING(party, struct joint_control, homing_run_servo_branch);
    csp_progress progress;

    switch (party->state) {
    case 0:
        do {
            /* PositionController (laws.csp:56) */
            csp_require_written(csp, &self->leftmax_written);
            if (csp_raised_in(csp, party, "homing.servo", "laws.csp:56")) {
                goto fails;
            }
            self->homing_servo_leftmax = self->leftmax;
            csp_require_written(csp, &self->rightmax_written);
            if (csp_raised_in(csp, party, "homing.servo", "laws.csp:56")) {
                goto fails;
            }
            self->homing_servo_rightmax = self->rightmax;
            CSP_AWAIT(csp_sampled_read(csp, party, &self->homing_feedback,
                    &self->homing_servo_feedback, sizeof(self->homing_servo_feedback)),
                csp_sampled_read_again(csp, party, &self->homing_feedback,
                    &self->homing_servo_feedback, sizeof(self->homing_servo_feedback)),
                HOMING_RUN_SERVO_READS_FEEDBACK, fails)
            /* homing.servo (jiwy.csp:97) */
            joint_control_homing_servo_calculate(csp, self);
            if (csp_raised_in(csp, party, "homing.servo", "jiwy.csp:97")) {
                goto fails;
            }
            /* PositionController (laws.csp:56) */
            if (csp_refused(csp, party)) {
                goto fails;
            }
            (void)csp_latched_write(party, self->control, &self->homing_servo_control,
                sizeof(self->homing_servo_control));
            self->homing_reference = self->homing_servo_reference;
            self->homing_stop = self->homing_servo_stop;
        } while (!self->homing_stop);
        return csp_end(csp, party);
    case HOMING_RUN_SERVO_FAILS:
    fails:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place joint_control_homing_run_servo_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "jiwy.csp:104"},
    [HOMING_RUN_SERVO_READS_FEEDBACK] = {
        .waiting = CSP_AT_READ,
        .failed = HOMING_RUN_SERVO_FAILS,
        .where = "laws.csp:56",
        .inner = "homing.servo",
        .offset = offsetof(struct joint_control, homing_feedback)
    },
    [HOMING_RUN_SERVO_FAILS] = {
        .waiting = CSP_AT_NOTHING,
        .failed = HOMING_RUN_SERVO_FAILS,
        .where = "jiwy.csp:104"
    }
};

static const csp_class joint_control_homing_run_servo_class = {
    .step = joint_control_homing_run_servo_step,
    .places = joint_control_homing_run_servo_places,
    .name = "JointControl",
    .where = "jiwy.csp:104",
    .offset = offsetof(struct joint_control, homing_run_servo_branch),
    .states = CSP_STATES(joint_control_homing_run_servo_places)
};

static csp_party *joint_control_align_r_run_velocity_step(csp_kernel *csp, csp_party *party)
{
    struct joint_control *const self =
        CSP_ENCLOSING(party, struct joint_control, alignR_run_velocity_branch);
    csp_progress progress;

    switch (party->state) {
    case 0:
        do {
            /* VelocityController (laws.csp:88) */
            CSP_AWAIT(csp_sampled_read(csp, party, &self->alignR_feedback,
                    &self->alignR_velocity_feedback, sizeof(self->alignR_velocity_feedback)),
                csp_sampled_read_again(csp, party, &self->alignR_feedback,
                    &self->alignR_velocity_feedback, sizeof(self->alignR_velocity_feedback)),
                ALIGN_R_RUN_VELOCITY_READS_FEEDBACK, fails)
            /* alignR.velocity (jiwy.csp:39) */
            joint_control_align_r_velocity_calculate(csp, self);
            if (csp_raised_in(csp, party, "alignR.velocity", "jiwy.csp:39")) {
                goto fails;
            }
            /* VelocityController (laws.csp:88) */
            if (csp_refused(csp, party)) {
                goto fails;
            }
            (void)csp_latched_write(party, self->control, &self->alignR_velocity_control,
                sizeof(self->alignR_velocity_control));
            self->rightmax = self->alignR_velocity_feedback;
            self->rightmax_written.done = true;
            self->alignR_stop = self->alignR_velocity_stop;
        } while (!self->alignR_stop);
        return csp_end(csp, party);
    case ALIGN_R_RUN_VELOCITY_FAILS:
    fails:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place joint_control_align_r_run_velocity_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "jiwy.csp:104"},
    [ALIGN_R_RUN_VELOCITY_READS_FEEDBACK] = {
        .waiting = CSP_AT_READ,
        .failed = ALIGN_R_RUN_VELOCITY_FAILS,
        .where = "laws.csp:88",
        .inner = "alignR.velocity",
        .offset = offsetof(struct joint_control, alignR_feedback)
    },
    [ALIGN_R_RUN_VELOCITY_FAILS] = {
        .waiting = CSP_AT_NOTHING,
        .failed = ALIGN_R_RUN_VELOCITY_FAILS,
        .where = "jiwy.csp:104"
    }
};

static const csp_class joint_control_align_r_run_velocity_class = {
    .step = joint_control_align_r_run_velocity_step,
    .places = joint_control_align_r_run_velocity_places,
    .name = "JointControl",
    .where = "jiwy.csp:104",
    .offset = offsetof(struct joint_control, alignR_run_velocity_branch),
    .states = CSP_STATES(joint_control_align_r_run_velocity_places)
};

static csp_party *joint_control_align_l_run_velocity_step(csp_kernel *csp, csp_party *party)
{
    struct joint_control *const self =
        CSP_ENCLOSING(party, struct joint_control, alignL_run_velocity_branch);
    csp_progress progress;

    switch (party->state) {
    case 0:
        do {
            /* VelocityController (laws.csp:88) */
            CSP_AWAIT(csp_sampled_read(csp, party, &self->alignL_feedback,
                    &self->alignL_velocity_feedback, sizeof(self->alignL_velocity_feedback)),
                csp_sampled_read_again(csp, party, &self->alignL_feedback,
                    &self->alignL_velocity_feedback, sizeof(self->alignL_velocity_feedback)),
                ALIGN_L_RUN_VELOCITY_READS_FEEDBACK, fails)
            /* alignL.velocity (jiwy.csp:39) */
            joint_control_align_l_velocity_calculate(csp, self);
            if (csp_raised_in(csp, party, "alignL.velocity", "jiwy.csp:39")) {
                goto fails;
            }
            /* VelocityController (laws.csp:88) */
            if (csp_refused(csp, party)) {
                goto fails;
            }
            (void)csp_latched_write(party, self->control, &self->alignL_velocity_control,
                sizeof(self->alignL_velocity_control));
            self->leftmax = self->alignL_velocity_feedback;
            self->leftmax_written.done = true;
            self->alignL_stop = self->alignL_velocity_stop;
        } while (!self->alignL_stop);
        return csp_end(csp, party);
    case ALIGN_L_RUN_VELOCITY_FAILS:
    fails:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place joint_control_align_l_run_velocity_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "jiwy.csp:104"},
    [ALIGN_L_RUN_VELOCITY_READS_FEEDBACK] = {
        .waiting = CSP_AT_READ,
        .failed = ALIGN_L_RUN_VELOCITY_FAILS,
        .where = "laws.csp:88",
        .inner = "alignL.velocity",
        .offset = offsetof(struct joint_control, alignL_feedback)
    },
    [ALIGN_L_RUN_VELOCITY_FAILS] = {
        .waiting = CSP_AT_NOTHING,
        .failed = ALIGN_L_RUN_VELOCITY_FAILS,
        .where = "jiwy.csp:104"
    }
};

static const csp_class joint_control_align_l_run_velocity_class = {
    .step = joint_control_align_l_run_velocity_step,
    .places = joint_control_align_l_run_velocity_places,
    .name = "JointControl",
    .where = "jiwy.csp:104",
    .offset = offsetof(struct joint_control, alignL_run_velocity_branch),
    .states = CSP_STATES(joint_control_align_l_run_velocity_places)
};

static csp_party *joint_control_fails(csp_kernel *csp, csp_party *party)
{
    csp_unwind(csp, party);
    csp_observe_end(csp, party->number);
    return csp_fail(csp, party);
}

static csp_party *joint_control_align_l(csp_kernel *csp, csp_party *party)
{
    struct joint_control *const self = CSP_ENCLOSING(party, struct joint_control, process);
    csp_progress progress;

    switch (party->state) {
    case ALIGN_L_BEGINS:
        /* alignL: Turns one joint at constant speed until it meets its end stop, and remembers
         * where that was. (jiwy.csp:129)
         */
        csp_observe_begin(csp, party->number + 1U);
        /* (mu velocity until stop) interrupt after patience -> fail... (jiwy.csp:39) */
        csp_interrupt_prepare(&self->alignL_interrupt_run_velocity);
        csp_guard_after(&self->alignL_interrupt_run_velocity.alternative, 0U,
            &self->alignL_interrupt_run_velocity.timer);
        csp_delay(&self->alignL_interrupt_run_velocity.alternative, 0U, 10 * CSP_S);
        CSP_AWAIT(csp_interruptible(csp, party, &self->alignL_interrupt_run_velocity),
            csp_interruptible_again(csp, party, &self->alignL_interrupt_run_velocity),
            ALIGN_L_INTERRUPTIBLE_RUN_VELOCITY, align_l_catches_timeout)
        if (self->alignL_interrupt_run_velocity.taken) {
            /* after patience (jiwy.csp:39) */
            /* failed := true (jiwy.csp:39) */
            self->alignL_failed = true;
        }
        goto after_align_l_catches_timeout;
    case ALIGN_L_CATCHES_TIMEOUT:
    align_l_catches_timeout:
        csp_unwind(csp, party);
        if (!csp_catch(csp, CSP_TIMEOUT_EXCEPTION)) {
            goto align_l_fails;
        }
        /* failed := true (jiwy.csp:39) */
        self->alignL_failed = true;
    after_align_l_catches_timeout:
        /* control ! 0<V> (jiwy.csp:40) */
        self->sent.control = 0.0;
        if (csp_refused(csp, party)) {
            goto align_l_fails;
        }
        (void)csp_latched_write(party, self->control, &self->sent.control,
            sizeof(self->sent.control));
        if (self->alignL_failed) {
            /* raise ModeFailed (jiwy.csp:41) */
            (void)csp_raise(csp, party, EXCEPTION_MODE_FAILED, "jiwy.csp:41");
            csp->error.inner = "alignL";
            goto align_l_fails;
        }
        csp_ends_close(&self->alignL_samples);
        csp_observe_end(csp, party->number + 1U);
        goto after_align_l_fails;
    align_l_fails:
        csp_unwind(csp, party);
        csp_ends_close(&self->alignL_samples);
        csp_observe_end(csp, party->number + 1U);
        goto fails;
    after_align_l_fails:
        party->state = (uint16_t)ALIGN_R_BEGINS;
        return party;
    fails:
        return joint_control_fails(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static csp_party *joint_control_align_r(csp_kernel *csp, csp_party *party)
{
    struct joint_control *const self = CSP_ENCLOSING(party, struct joint_control, process);
    csp_progress progress;

    switch (party->state) {
    case ALIGN_R_BEGINS:
        /* alignR: Turns one joint at constant speed until it meets its end stop, and remembers
         * where that was. (jiwy.csp:129)
         */
        csp_observe_begin(csp, party->number + 2U);
        /* (mu velocity until stop) interrupt after patience -> fail... (jiwy.csp:39) */
        csp_interrupt_prepare(&self->alignR_interrupt_run_velocity);
        csp_guard_after(&self->alignR_interrupt_run_velocity.alternative, 0U,
            &self->alignR_interrupt_run_velocity.timer);
        csp_delay(&self->alignR_interrupt_run_velocity.alternative, 0U, 10 * CSP_S);
        CSP_AWAIT(csp_interruptible(csp, party, &self->alignR_interrupt_run_velocity),
            csp_interruptible_again(csp, party, &self->alignR_interrupt_run_velocity),
            ALIGN_R_INTERRUPTIBLE_RUN_VELOCITY, align_r_catches_timeout)
        if (self->alignR_interrupt_run_velocity.taken) {
            /* after patience (jiwy.csp:39) */
            /* failed := true (jiwy.csp:39) */
            self->alignR_failed = true;
        }
        goto after_align_r_catches_timeout;
    case ALIGN_R_CATCHES_TIMEOUT:
    align_r_catches_timeout:
        csp_unwind(csp, party);
        if (!csp_catch(csp, CSP_TIMEOUT_EXCEPTION)) {
            goto align_r_fails;
        }
        /* failed := true (jiwy.csp:39) */
        self->alignR_failed = true;
    after_align_r_catches_timeout:
        /* control ! 0<V> (jiwy.csp:40) */
        self->sent.control = 0.0;
        if (csp_refused(csp, party)) {
            goto align_r_fails;
        }
        (void)csp_latched_write(party, self->control, &self->sent.control,
            sizeof(self->sent.control));
        if (self->alignR_failed) {
            /* raise ModeFailed (jiwy.csp:41) */
            (void)csp_raise(csp, party, EXCEPTION_MODE_FAILED, "jiwy.csp:41");
            csp->error.inner = "alignR";
            goto align_r_fails;
        }
        csp_ends_close(&self->alignR_samples);
        csp_observe_end(csp, party->number + 2U);
        goto after_align_r_fails;
    align_r_fails:
        csp_unwind(csp, party);
        csp_ends_close(&self->alignR_samples);
        csp_observe_end(csp, party->number + 2U);
        goto fails;
    after_align_r_fails:
        party->state = (uint16_t)MOTION_CONTROL_BEGINS;
        return party;
    fails:
        return joint_control_fails(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static csp_party *joint_control_motion_control(csp_kernel *csp, csp_party *party)
{
    struct joint_control *const self = CSP_ENCLOSING(party, struct joint_control, process);
    csp_progress progress;

    switch (party->state) {
    case MOTION_CONTROL_BEGINS:
        /* motionControl: Servo that follows the joystick until the stop button is pressed, then
         * releases the motor. (jiwy.csp:129)
         */
        csp_observe_begin(csp, party->number + 3U);
        do {
            /* joystick_buttons ? status -> skip []> feedback -> servo (jiwy.csp:68) */
            CSP_AWAIT(csp_select(csp, party, &self->motionControl_choice.alternative),
                csp_select_again(csp, party, &self->motionControl_choice.alternative),
                MOTION_CONTROL_CHOOSES, motion_control_catches_timeout)
            if (self->motionControl_choice.alternative.chosen != 0U) {
                /* feedback (jiwy.csp:68) */
                /* PositionController (laws.csp:56) */
                if (csp_offers_begin(csp, party, &self->offers) == CSP_FAILS) {
                    goto motion_control_catches_timeout;
                }
                csp_require_written(csp, &self->leftmax_written);
                if (csp_raised_in(csp, party, "motionControl.servo", "laws.csp:56")) {
                    csp_offers_give_up(csp, &self->offers);
                    goto motion_control_catches_timeout;
                }
                self->motionControl_servo_leftmax = self->leftmax;
                csp_require_written(csp, &self->rightmax_written);
                if (csp_raised_in(csp, party, "motionControl.servo", "laws.csp:56")) {
                    csp_offers_give_up(csp, &self->offers);
                    goto motion_control_catches_timeout;
                }
                self->motionControl_servo_rightmax = self->rightmax;
                if (CSP_OFFER(&self->offers, csp_sampled_read, &self->motionControl_feedback,
                            self->motionControl_servo_feedback)
                        == CSP_FAILS) {
                    party->state = (uint16_t)MOTION_CONTROL_READS_INPUTS;
                    goto motion_control_catches_timeout;
                }
                if (CSP_OFFER(&self->offers, csp_sampled_read, &self->motionControl_joystick_axis,
                            self->motionControl_servo_setpoint)
                        == CSP_FAILS) {
                    party->state = (uint16_t)MOTION_CONTROL_READS_INPUTS;
                    goto motion_control_catches_timeout;
                }
                CSP_AWAIT(csp_offers_wait(&self->offers), csp_offers_again(party, &self->offers),
                    MOTION_CONTROL_READS_INPUTS, motion_control_catches_timeout)
                /* motionControl.servo (jiwy.csp:68) */
                joint_control_motion_control_servo_calculate(csp, self);
                if (csp_raised_in(csp, party, "motionControl.servo", "jiwy.csp:68")) {
                    goto motion_control_catches_timeout;
                }
                /* PositionController (laws.csp:56) */
                if (csp_refused(csp, party)) {
                    goto motion_control_catches_timeout;
                }
                (void)csp_latched_write(party, self->control, &self->motionControl_servo_control,
                    sizeof(self->motionControl_servo_control));
                self->motionControl_reference = self->motionControl_servo_reference;
            }
        } while (self->motionControl_status != stopButton);
        goto after_motion_control_catches_timeout;
    case MOTION_CONTROL_CATCHES_TIMEOUT:
    motion_control_catches_timeout:
        csp_unwind(csp, party);
        if (!csp_catch(csp, CSP_TIMEOUT_EXCEPTION)) {
            goto motion_control_fails;
        }
        /* failed := true (jiwy.csp:69) */
        self->motionControl_failed = true;
    after_motion_control_catches_timeout:
        /* control ! 0<V> (jiwy.csp:70) */
        self->sent.control = 0.0;
        if (csp_refused(csp, party)) {
            goto motion_control_fails;
        }
        (void)csp_latched_write(party, self->control, &self->sent.control,
            sizeof(self->sent.control));
        if (self->motionControl_failed) {
            /* raise ModeFailed (jiwy.csp:71) */
            (void)csp_raise(csp, party, EXCEPTION_MODE_FAILED, "jiwy.csp:71");
            csp->error.inner = "motionControl";
            goto motion_control_fails;
        }
        csp_ends_close(&self->motionControl_samples);
        csp_observe_end(csp, party->number + 3U);
        goto after_motion_control_fails;
    motion_control_fails:
        csp_unwind(csp, party);
        csp_ends_close(&self->motionControl_samples);
        csp_observe_end(csp, party->number + 3U);
        goto fails;
    after_motion_control_fails:
        party->state = (uint16_t)HOMING_BEGINS;
        return party;
    fails:
        return joint_control_fails(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static csp_party *joint_control_homing(csp_kernel *csp, csp_party *party)
{
    struct joint_control *const self = CSP_ENCLOSING(party, struct joint_control, process);
    csp_progress progress;

    switch (party->state) {
    case HOMING_BEGINS:
        /* homing: Servo back to the centre; there, or where its patience ends, the motor is
         * released. (jiwy.csp:129)
         */
        csp_observe_begin(csp, party->number + 4U);
        /* (mu servo until stop) interrupt after patience -> skip (jiwy.csp:97) */
        csp_interrupt_prepare(&self->homing_interrupt_run_servo);
        csp_guard_after(&self->homing_interrupt_run_servo.alternative, 0U,
            &self->homing_interrupt_run_servo.timer);
        csp_delay(&self->homing_interrupt_run_servo.alternative, 0U, 3 * CSP_S);
        CSP_AWAIT(csp_interruptible(csp, party, &self->homing_interrupt_run_servo),
            csp_interruptible_again(csp, party, &self->homing_interrupt_run_servo),
            HOMING_INTERRUPTIBLE_RUN_SERVO, homing_catches_timeout)
        /* after patience (jiwy.csp:97) */
        goto after_homing_catches_timeout;
    case HOMING_CATCHES_TIMEOUT:
    homing_catches_timeout:
        csp_unwind(csp, party);
        if (!csp_catch(csp, CSP_TIMEOUT_EXCEPTION)) {
            goto homing_fails;
        }
        /* failed := true (jiwy.csp:97) */
        self->homing_failed = true;
    after_homing_catches_timeout:
        /* control ! 0<V> (jiwy.csp:98) */
        self->sent.control = 0.0;
        if (csp_refused(csp, party)) {
            goto homing_fails;
        }
        (void)csp_latched_write(party, self->control, &self->sent.control,
            sizeof(self->sent.control));
        if (self->homing_failed) {
            /* raise ModeFailed (jiwy.csp:99) */
            (void)csp_raise(csp, party, EXCEPTION_MODE_FAILED, "jiwy.csp:99");
            csp->error.inner = "homing";
            goto homing_fails;
        }
        csp_ends_close(&self->homing_samples);
        csp_observe_end(csp, party->number + 4U);
        goto after_homing_fails;
    homing_fails:
        csp_unwind(csp, party);
        csp_ends_close(&self->homing_samples);
        csp_observe_end(csp, party->number + 4U);
        goto fails;
    after_homing_fails:
        party->state = (uint16_t)JOINT_CONTROL_ENDS;
        return party;
    fails:
        return joint_control_fails(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static csp_party *joint_control_step(csp_kernel *csp, csp_party *party)
{
    switch (party->state) {
    case 0:
        csp_observe_begin(csp, party->number);
        party->state = (uint16_t)ALIGN_L_BEGINS;
        return party;
    case ALIGN_L_BEGINS:
    case ALIGN_L_INTERRUPTIBLE_RUN_VELOCITY:
    case ALIGN_L_CATCHES_TIMEOUT:
        return joint_control_align_l(csp, party);
    case ALIGN_R_BEGINS:
    case ALIGN_R_INTERRUPTIBLE_RUN_VELOCITY:
    case ALIGN_R_CATCHES_TIMEOUT:
        return joint_control_align_r(csp, party);
    case MOTION_CONTROL_BEGINS:
    case MOTION_CONTROL_CHOOSES:
    case MOTION_CONTROL_READS_INPUTS:
    case MOTION_CONTROL_CATCHES_TIMEOUT:
        return joint_control_motion_control(csp, party);
    case HOMING_BEGINS:
    case HOMING_INTERRUPTIBLE_RUN_SERVO:
    case HOMING_CATCHES_TIMEOUT:
        return joint_control_homing(csp, party);
    case JOINT_CONTROL_ENDS:
        csp_observe_end(csp, party->number);
        return csp_end(csp, party);
    case FAILS:
        return joint_control_fails(csp, party);
    default:
        return csp_overwritten(csp, party);
    }
}

static const csp_place joint_control_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "jiwy.csp:104"},
    [ALIGN_L_INTERRUPTIBLE_RUN_VELOCITY] = {
        .waiting = CSP_AT_INTERRUPT,
        .failed = ALIGN_L_CATCHES_TIMEOUT,
        .where = "jiwy.csp:39",
        .inner = "alignL",
        .offset = offsetof(struct joint_control, alignL_interrupt_run_velocity)
    },
    [ALIGN_L_CATCHES_TIMEOUT] = {
        .waiting = CSP_AT_NOTHING,
        .failed = ALIGN_L_CATCHES_TIMEOUT,
        .where = "jiwy.csp:39"
    },
    [ALIGN_R_INTERRUPTIBLE_RUN_VELOCITY] = {
        .waiting = CSP_AT_INTERRUPT,
        .failed = ALIGN_R_CATCHES_TIMEOUT,
        .where = "jiwy.csp:39",
        .inner = "alignR",
        .offset = offsetof(struct joint_control, alignR_interrupt_run_velocity)
    },
    [ALIGN_R_CATCHES_TIMEOUT] = {
        .waiting = CSP_AT_NOTHING,
        .failed = ALIGN_R_CATCHES_TIMEOUT,
        .where = "jiwy.csp:39"
    },
    [MOTION_CONTROL_CHOOSES] = {
        .waiting = CSP_AT_ALTERNATIVE,
        .failed = MOTION_CONTROL_CATCHES_TIMEOUT,
        .where = "jiwy.csp:68",
        .inner = "motionControl",
        .offset = offsetof(struct joint_control, motionControl_choice.alternative)
    },
    [MOTION_CONTROL_READS_INPUTS] = {
        .waiting = CSP_AT_INPUTS,
        .failed = MOTION_CONTROL_CATCHES_TIMEOUT,
        .where = "laws.csp:56",
        .inner = "motionControl.servo",
        .offset = offsetof(struct joint_control, offers)
    },
    [MOTION_CONTROL_CATCHES_TIMEOUT] = {
        .waiting = CSP_AT_NOTHING,
        .failed = MOTION_CONTROL_CATCHES_TIMEOUT,
        .where = "jiwy.csp:68"
    },
    [HOMING_INTERRUPTIBLE_RUN_SERVO] = {
        .waiting = CSP_AT_INTERRUPT,
        .failed = HOMING_CATCHES_TIMEOUT,
        .where = "jiwy.csp:97",
        .inner = "homing",
        .offset = offsetof(struct joint_control, homing_interrupt_run_servo)
    },
    [HOMING_CATCHES_TIMEOUT] = {
        .waiting = CSP_AT_NOTHING,
        .failed = HOMING_CATCHES_TIMEOUT,
        .where = "jiwy.csp:97"
    },
    [ALIGN_L_BEGINS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "jiwy.csp:129"},
    [ALIGN_R_BEGINS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "jiwy.csp:129"},
    [MOTION_CONTROL_BEGINS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "jiwy.csp:129"},
    [HOMING_BEGINS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "jiwy.csp:129"},
    [JOINT_CONTROL_ENDS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "jiwy.csp:104"},
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
    double alignKp)
{
    csp_process_init(&self->process, &joint_control_class, numbers->process);
    numbers->process += 5U;
    self->gains = gains;
    self->alignKp = alignKp;
    self->control = ports->control;
    self->leftmax_written.number = numbers->variable;
    numbers->variable++;
    self->rightmax_written.number = numbers->variable;
    numbers->variable++;
    self->alignL_failed = false;
    self->alignR_failed = false;
    self->motionControl_status = 0;
    self->motionControl_failed = false;
    self->homing_failed = false;
    self->alignL_velocity_sample = csp_seconds(T);
    self->alignR_velocity_sample = csp_seconds(T);
    self->motionControl_servo_sample = csp_seconds(T);
    self->homing_servo_sample = csp_seconds(T);
    self->alignL_velocity_moving = false;
    self->alignL_velocity_last = 0.0;
    self->alignL_velocity_filtered = 0.0;
    self->alignL_velocity_ui = 0.0;
    self->alignL_velocity_pressed = 0.0;
    self->alignR_velocity_moving = false;
    self->alignR_velocity_last = 0.0;
    self->alignR_velocity_filtered = 0.0;
    self->alignR_velocity_ui = 0.0;
    self->alignR_velocity_pressed = 0.0;
    self->motionControl_servo_profile_moving = false;
    self->motionControl_servo_profile_last = 0.0;
    self->motionControl_servo_pid_e1 = 0.0;
    self->motionControl_servo_pid_ud = 0.0;
    self->motionControl_servo_pid_ui = 0.0;
    self->motionControl_servo_arrived = 0.0;
    self->homing_servo_profile_moving = false;
    self->homing_servo_profile_last = 0.0;
    self->homing_servo_pid_e1 = 0.0;
    self->homing_servo_pid_ud = 0.0;
    self->homing_servo_pid_ui = 0.0;
    self->homing_servo_arrived = 0.0;
    csp_offers_init(&self->offers, self->offers_made, 2U);
    csp_sampled_end_init(&self->alignL_feedback, ports->feedback, &self->alignL_samples);
    csp_sampled_end_init(&self->alignR_feedback, ports->feedback, &self->alignR_samples);
    self->joystick_buttons =
        csp_event_reader(&self->joystick_buttons_latch, ports->joystick_buttons);
    csp_sampled_end_init(&self->motionControl_feedback, ports->feedback,
        &self->motionControl_samples);
    csp_sampled_end_init(&self->motionControl_joystick_axis, ports->joystick_axis,
        &self->motionControl_samples);
    csp_alternative_init(&self->motionControl_choice.alternative, self->motionControl_choice.guards,
        2U, NULL, true);
    csp_guard_read(&self->motionControl_choice.alternative, 0U, &self->joystick_buttons->medium,
        &self->motionControl_status, sizeof(self->motionControl_status));
    csp_guard_ready(&self->motionControl_choice.alternative, 1U,
        &self->motionControl_feedback.medium);
    csp_enable_all(&self->motionControl_choice.alternative);
    csp_sampled_end_init(&self->homing_feedback, ports->feedback, &self->homing_samples);
    csp_process_init(&self->alignL_run_velocity_branch, &joint_control_align_l_run_velocity_class,
        self->process.party.number);
    csp_interrupt_init(&self->alignL_interrupt_run_velocity,
        (uint32_t)offsetof(struct joint_control, alignL_run_velocity_branch));
    csp_process_init(&self->alignR_run_velocity_branch, &joint_control_align_r_run_velocity_class,
        self->process.party.number);
    csp_interrupt_init(&self->alignR_interrupt_run_velocity,
        (uint32_t)offsetof(struct joint_control, alignR_run_velocity_branch));
    csp_process_init(&self->homing_run_servo_branch, &joint_control_homing_run_servo_class,
        self->process.party.number);
    csp_interrupt_init(&self->homing_interrupt_run_servo,
        (uint32_t)offsetof(struct joint_control, homing_run_servo_branch));
}
