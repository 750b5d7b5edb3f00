/* SPDX-License-Identifier: 0BSD */
/* See position_controller.h. */
#include "position_controller.h"

#include "csp_arithmetic.h"
#include "constants.h"

void position_controller_initialize(struct position_controller *self,
    const struct jiwy_servo_gains *gains, double reach, double rate, int64_t smoothing,
    int64_t dwell, double margin, double sample)
{
    self->gains = gains;
    self->reach = reach;
    self->rate = rate;
    self->smoothing = csp_seconds(smoothing);
    self->dwell = csp_seconds(dwell);
    self->margin = margin;
    self->sample = sample;
    position_controller_reset(self);
}

void position_controller_reset(struct position_controller *self)
{
    self->profile_moving = false;
    self->profile_last = 0.0;
    self->pid_e1 = 0.0;
    self->pid_ud = 0.0;
    self->pid_ui = 0.0;
    self->arrived = 0.0;
}

void position_controller_calculate(csp_kernel *csp, struct position_controller *self)
{
    const double pid_tauD = csp_seconds(self->gains->tauD); /* laws.csp:6 */
    const double pid_beta = self->gains->beta; /* laws.csp:6 */
    const double pid_f = csp_divide(csp, 1.0, self->sample + pid_tauD * pid_beta); /* laws.csp:14 */
    if (csp_faulted_at(csp, "laws.csp:14")) {
        return;
    }
    const double pid_kp = self->gains->kp; /* laws.csp:6 */
    const double pid_tauI = csp_seconds(self->gains->tauI); /* laws.csp:6 */
    const double centre = (self->leftmax + self->rightmax) / 2.0; /* laws.csp:71 */
    /* laws.csp:72 */
    self->reference = csp_real(csp,
        csp_limit(centre + self->reach * self->setpoint, self->leftmax + self->margin,
            self->rightmax - self->margin));
    if (csp_faulted_at(csp, "laws.csp:72")) {
        return;
    }
    const double profile_start = self->feedback; /* laws.csp:73 */
    /* laws.csp:35 */
    const double profile_from = self->profile_moving ? self->profile_last : profile_start;
    const double profile_target = self->reference; /* laws.csp:74 */
    /* laws.csp:36 */
    const double profile_velocity = csp_limit(
        csp_divide(csp, profile_target - profile_from, self->smoothing), -self->rate, self->rate);
    if (csp_faulted_at(csp, "laws.csp:36")) {
        return;
    }
    const double profile_angle = profile_from + self->sample * profile_velocity; /* laws.csp:37 */
    const double pid_error = profile_angle - self->feedback; /* laws.csp:75 */
    /* laws.csp:15 */
    const double pid_d = pid_f
        * (pid_tauD * pid_beta * self->pid_ud
            + pid_tauD * pid_kp * (pid_error - self->pid_e1)
            + self->sample * pid_kp * pid_error);
    /* laws.csp:16 */
    const double pid_i = self->pid_ui + csp_divide(csp, self->sample * pid_d, pid_tauI);
    if (csp_faulted_at(csp, "laws.csp:16")) {
        return;
    }
    const double pid_sum = pid_i + pid_d; /* laws.csp:17 */
    const double pid_output = csp_limit(pid_sum, -0.99, 0.99); /* laws.csp:19 */
    /* laws.csp:77 */
    const double assistance = self->gains->friction * csp_limit(profile_velocity / 0.05, -1.0, 1.0);
    self->control = csp_limit(supply * pid_output + assistance, -supply, supply); /* laws.csp:78 */
    /* laws.csp:80 */
    const double standing = (fabs(self->reference - self->feedback) < self->gains->tolerance)
        ? self->arrived + self->sample
        : 0.0;
    self->stop = standing >= self->dwell; /* laws.csp:82 */
    const double profile_last_next = profile_angle; /* laws.csp:39 */
    const double pid_e1_next = pid_error; /* laws.csp:20 */
    const double pid_ud_next = pid_d; /* laws.csp:21 */
    const double pid_ui_next = (pid_sum == pid_output) ? pid_i : self->pid_ui; /* laws.csp:22 */
    const double arrived_next = standing; /* laws.csp:81 */
    /* A sum is finite only if its terms are. */
    if (!csp_is_finite(
            self->control
                + profile_last_next
                + pid_e1_next
                + pid_ud_next
                + pid_ui_next
                + arrived_next)) {
        csp_finite_at(csp, self->control, "laws.csp:78");
        csp_finite_at(csp, profile_last_next, "laws.csp:39");
        csp_finite_at(csp, pid_e1_next, "laws.csp:20");
        csp_finite_at(csp, pid_ud_next, "laws.csp:21");
        csp_finite_at(csp, pid_ui_next, "laws.csp:22");
        csp_finite_at(csp, arrived_next, "laws.csp:81");
        if (csp_faulted_at(csp, "laws.csp:81")) {
            return;
        }
    }
    self->profile_moving = true; /* laws.csp:38 */
    self->profile_last = profile_last_next; /* laws.csp:39 */
    self->pid_e1 = pid_e1_next; /* laws.csp:20 */
    self->pid_ud = pid_ud_next; /* laws.csp:21 */
    self->pid_ui = pid_ui_next; /* laws.csp:22 */
    self->arrived = arrived_next; /* laws.csp:81 */
}
