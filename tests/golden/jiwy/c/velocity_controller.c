/* SPDX-License-Identifier: 0BSD */
/* See velocity_controller.h. */
#include "velocity_controller.h"

#include "csp_arithmetic.h"

void velocity_controller_initialize(struct velocity_controller *self, double speed, double kp,
    double ki, double pressure, double effort, int64_t filter, int64_t dwell, double sample)
{
    self->speed = speed;
    self->kp = kp;
    self->ki = ki;
    self->pressure = pressure;
    self->effort = effort;
    self->filter = csp_seconds(filter);
    self->dwell = csp_seconds(dwell);
    self->sample = sample;
    velocity_controller_reset(self);
}

void velocity_controller_reset(struct velocity_controller *self)
{
    self->moving = false;
    self->last = 0.0;
    self->filtered = 0.0;
    self->ui = 0.0;
    self->pressed = 0.0;
}

void velocity_controller_calculate(csp_kernel *csp, struct velocity_controller *self)
{
    /* laws.csp:103 */
    const double difference =
        self->moving ? csp_divide(csp, self->feedback - self->last, self->sample) : 0.0;
    if (csp_faulted_at(csp, "laws.csp:103")) {
        return;
    }
    /* laws.csp:104 */
    const double velocity = self->filtered
        + csp_divide(csp, self->sample, self->filter + self->sample)
            * (difference - self->filtered);
    if (csp_faulted_at(csp, "laws.csp:104")) {
        return;
    }
    const double error = self->speed - velocity; /* laws.csp:105 */
    const double i = self->ui + self->sample * self->ki * error; /* laws.csp:106 */
    const double sum = self->kp * error + i; /* laws.csp:107 */
    self->control = csp_limit(sum, -self->pressure, self->pressure); /* laws.csp:109 */
    /* laws.csp:115 */
    const bool pressing = (fabs(velocity) < 0.1 * fabs(self->speed))
        && (self->control * csp_sign(self->speed) > self->effort);
    const double held = pressing ? self->pressed + self->sample : 0.0; /* laws.csp:116 */
    self->stop = held >= self->dwell; /* laws.csp:118 */
    self->max = self->feedback; /* laws.csp:119 */
    const double filtered_next = velocity; /* laws.csp:112 */
    const double ui_next = (sum == self->control) ? i : self->ui; /* laws.csp:113 */
    const double pressed_next = held; /* laws.csp:117 */
    /* A sum is finite only if its terms are. */
    if (!csp_is_finite(self->control + filtered_next + ui_next + pressed_next)) {
        csp_finite_at(csp, self->control, "laws.csp:109");
        csp_finite_at(csp, filtered_next, "laws.csp:112");
        csp_finite_at(csp, ui_next, "laws.csp:113");
        csp_finite_at(csp, pressed_next, "laws.csp:117");
        if (csp_faulted_at(csp, "laws.csp:117")) {
            return;
        }
    }
    self->moving = true; /* laws.csp:110 */
    self->last = self->feedback; /* laws.csp:111 */
    self->filtered = filtered_next; /* laws.csp:112 */
    self->ui = ui_next; /* laws.csp:113 */
    self->pressed = pressed_next; /* laws.csp:117 */
}
