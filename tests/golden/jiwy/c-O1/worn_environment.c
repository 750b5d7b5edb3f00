/* SPDX-License-Identifier: 0BSD */
/* See worn_environment.h. */
#include "worn_environment.h"

#include "csp_arithmetic.h"
#include "constants.h"

static const double pan_start = 1.4; /* plant.csp:26 */
static const double pan_left = -1.62; /* plant.csp:26 */
static const double pan_damper = 0.3; /* plant.csp:26 */
static const double pan_right = 1.5; /* plant.csp:26 */
static const double pan_inertia = 0.001; /* plant.csp:25 */
static const double pan_viscous = 0.0013; /* plant.csp:25 */
static const double pan_gravity = 0.0; /* plant.csp:25 */
static const double pan_coulomb = 0.0156; /* plant.csp:25 */
static const double pan_creep = 0.02; /* plant.csp:27 */
static const double pan_settling = 0.002; /* plant.csp:27 */
static const double tilt_start = -2.0; /* plant.csp:26 */
static const double tilt_left = -2.05; /* plant.csp:26 */
static const double tilt_damper = 0.15; /* plant.csp:26 */
static const double tilt_right = 1.85; /* plant.csp:26 */
static const double tilt_inertia = 0.0003; /* plant.csp:25 */
static const double tilt_viscous = 0.00065; /* plant.csp:25 */
static const double tilt_gravity = 0.01; /* plant.csp:25 */
static const double tilt_coulomb = 0.0104; /* plant.csp:25 */
static const double tilt_creep = 0.04; /* plant.csp:27 */
static const double tilt_settling = 0.002; /* plant.csp:27 */

static struct worn_environment present;

static bool read_double(void *device, void *value)
{
    *(double *)value = *(const double *)device;
    return true;
}

static bool poll_int64(void *device, void *value)
{
    /* The present and the last value: an event is a change. */
    int64_t *const signal = device;
    const bool changed = signal[0] != signal[1];
    signal[1] = signal[0];
    *(int64_t *)value = signal[0];
    return changed;
}

static void write_double(void *device, const void *value)
{
    *(double *)device = *(const double *)value;
}

struct worn_environment_slopes {
    double pan_angle;
    double pan_speed;
    double tilt_angle;
    double tilt_speed;
};

static inline struct worn_environment_slopes worn_environment_slopes(csp_kernel *csp,
    const struct worn_environment *self, double pan_angle, double pan_speed, double tilt_angle,
    double tilt_speed, double pan_voltage, double tilt_voltage)
{
    /* plant.csp:35 */
    const double pan_stop = (pan_angle < pan_left)
        ? csp_max(0.0, stiffness * (pan_left - pan_angle) - pan_damper * pan_speed)
        : ((pan_angle > pan_right)
            ? csp_min(0.0, stiffness * (pan_right - pan_angle) - pan_damper * pan_speed)
            : 0.0);
    /* plant.csp:35 */
    const double tilt_stop = (tilt_angle < tilt_left)
        ? csp_max(0.0, stiffness * (tilt_left - tilt_angle) - tilt_damper * tilt_speed)
        : ((tilt_angle > tilt_right)
            ? csp_min(0.0, stiffness * (tilt_right - tilt_angle) - tilt_damper * tilt_speed)
            : 0.0);
    /* plant.csp:40 */
    const double pan_torque = drive * (pan_voltage - induction * pan_speed)
        - pan_viscous * pan_speed
        - pan_gravity * csp_sin(pan_angle)
        + pan_stop;
    /* plant.csp:42 */
    const double pan_friction = (fabs(pan_speed) < pan_creep)
        ? csp_limit(pan_torque + self->pan_mass * pan_speed / pan_settling, -self->pan_stiction,
            self->pan_stiction)
        : ((pan_speed > 0.0) ? pan_coulomb : -pan_coulomb);
    /* plant.csp:40 */
    const double tilt_torque = drive * (tilt_voltage - induction * tilt_speed)
        - tilt_viscous * tilt_speed
        - tilt_gravity * csp_sin(tilt_angle)
        + tilt_stop;
    /* plant.csp:42 */
    const double tilt_friction = (fabs(tilt_speed) < tilt_creep)
        ? csp_limit(tilt_torque + self->tilt_mass * tilt_speed / tilt_settling,
            -self->tilt_stiction, self->tilt_stiction)
        : ((tilt_speed > 0.0) ? tilt_coulomb : -tilt_coulomb);
    struct worn_environment_slopes slopes;
    slopes.pan_angle = pan_speed;
    slopes.pan_speed = csp_divide(csp, pan_torque - pan_friction, self->pan_mass);
    csp_fault_in(csp, "plant.csp:48");
    slopes.tilt_angle = tilt_speed;
    slopes.tilt_speed = csp_divide(csp, tilt_torque - tilt_friction, self->tilt_mass);
    csp_fault_in(csp, "plant.csp:48");
    return slopes;
}

static bool worn_environment_evaluate(csp_kernel *csp, struct worn_environment *self)
{
    const double time = csp_seconds(self->now);
    /* plant.csp:49 */
    const double pan_encoder = csp_quantize(self->pan_angle - pan_start, 2.0 * CSP_PI / counts);
    /* plant.csp:49 */
    const double tilt_encoder = csp_quantize(self->tilt_angle - tilt_start, 2.0 * CSP_PI / counts);
    const double hand_phase = 2.0 * CSP_PI * 0.4 * time; /* plant.csp:74 */
    const double hand_x = 0.5 * csp_sin(hand_phase); /* plant.csp:75 */
    const double hand_y = 0.5 * csp_cos(hand_phase); /* plant.csp:76 */
    /* plant.csp:77 */
    const int64_t hand_buttons = (((time >= 2.0) && (time < 2.2)) || (time >= 15.0)) ? 2 : 0;
    self->feedback_horizontal = pan_encoder; /* jiwy.csp:196 */
    self->feedback_vertical = tilt_encoder; /* jiwy.csp:197 */
    self->joystick_horizontal = hand_x; /* jiwy.csp:198 */
    self->joystick_vertical = hand_y; /* jiwy.csp:199 */
    self->joystick_buttons[0] = hand_buttons; /* jiwy.csp:200 */
    /* A sum is finite only if its terms are. */
    if (!csp_is_finite(
            pan_encoder + tilt_encoder + self->joystick_horizontal + self->joystick_vertical)) {
        csp_finite_at(csp, pan_encoder, "plant.csp:49");
        csp_finite_at(csp, tilt_encoder, "plant.csp:49");
        csp_finite_at(csp, self->joystick_horizontal, "jiwy.csp:198");
        csp_finite_at(csp, self->joystick_vertical, "jiwy.csp:199");
        if (csp_faulted_at(csp, "jiwy.csp:199")) {
            return false;
        }
    }
    return true;
}

static bool worn_environment_start(csp_kernel *csp, void *state)
{
    struct worn_environment *const self = state;
    self->now = 0;
    self->pan_mass = pan_inertia + csp_pow(ratio, 2.0) * rotorInertia; /* plant.csp:39 */
    self->pan_stiction = 1.3 * pan_coulomb; /* plant.csp:41 */
    self->tilt_mass = tilt_inertia + csp_pow(ratio, 2.0) * rotorInertia; /* plant.csp:39 */
    self->tilt_stiction = 1.3 * tilt_coulomb; /* plant.csp:41 */
    self->pan_angle = pan_start; /* plant.csp:32 */
    self->pan_speed = 0.0; /* plant.csp:33 */
    self->tilt_angle = tilt_start; /* plant.csp:32 */
    self->tilt_speed = 0.0; /* plant.csp:33 */
    (void)worn_environment_evaluate(csp, self);
    self->joystick_buttons[1] = self->joystick_buttons[0];
    return !csp_faulted(csp);
}

static bool worn_environment_advance(csp_kernel *csp, void *state, int64_t now)
{
    struct worn_environment *const self = state;
    double pan_angle = self->pan_angle;
    double pan_speed = self->pan_speed;
    double tilt_angle = self->tilt_angle;
    double tilt_speed = self->tilt_speed;
    const double pan_voltage = self->control_horizontal; /* jiwy.csp:194 */
    const double tilt_voltage = self->control_vertical; /* jiwy.csp:195 */
    const int64_t steps = (now - self->now + CSP_MS - 1) / CSP_MS;
    const double h = csp_seconds(now - self->now) / (double)steps;
    const double half = h / 2.0;
    const double sixth = h / 6.0;
    for (int64_t step = 0; step < steps; step++) {
        const struct worn_environment_slopes k1 = worn_environment_slopes(csp, self, pan_angle,
            pan_speed, tilt_angle, tilt_speed, pan_voltage, tilt_voltage);
        const struct worn_environment_slopes k2 = worn_environment_slopes(csp, self,
            pan_angle + half * k1.pan_angle, pan_speed + half * k1.pan_speed,
            tilt_angle + half * k1.tilt_angle, tilt_speed + half * k1.tilt_speed, pan_voltage,
            tilt_voltage);
        const struct worn_environment_slopes k3 = worn_environment_slopes(csp, self,
            pan_angle + half * k2.pan_angle, pan_speed + half * k2.pan_speed,
            tilt_angle + half * k2.tilt_angle, tilt_speed + half * k2.tilt_speed, pan_voltage,
            tilt_voltage);
        const struct worn_environment_slopes k4 = worn_environment_slopes(csp, self,
            pan_angle + h * k3.pan_angle, pan_speed + h * k3.pan_speed,
            tilt_angle + h * k3.tilt_angle, tilt_speed + h * k3.tilt_speed, pan_voltage,
            tilt_voltage);
        pan_angle +=
            sixth * (k1.pan_angle + 2.0 * k2.pan_angle + 2.0 * k3.pan_angle + k4.pan_angle);
        pan_speed +=
            sixth * (k1.pan_speed + 2.0 * k2.pan_speed + 2.0 * k3.pan_speed + k4.pan_speed);
        tilt_angle +=
            sixth * (k1.tilt_angle + 2.0 * k2.tilt_angle + 2.0 * k3.tilt_angle + k4.tilt_angle);
        tilt_speed +=
            sixth * (k1.tilt_speed + 2.0 * k2.tilt_speed + 2.0 * k3.tilt_speed + k4.tilt_speed);
    }
    /* A sum is finite only if its terms are. */
    if (csp_faulted(csp) || !csp_is_finite(pan_angle + pan_speed + tilt_angle + tilt_speed)) {
        csp_finite_at(csp, pan_angle, "plant.csp:47");
        csp_finite_at(csp, pan_speed, "plant.csp:48");
        csp_finite_at(csp, tilt_angle, "plant.csp:47");
        csp_finite_at(csp, tilt_speed, "plant.csp:48");
        if (csp_faulted_at(csp, "plant.csp:48")) {
            return false;
        }
    }
    self->pan_angle = pan_angle;
    self->pan_speed = pan_speed;
    self->tilt_angle = tilt_angle;
    self->tilt_speed = tilt_speed;
    self->now = now;
    return worn_environment_evaluate(csp, self);
}

const struct network_drivers worn_environment_drivers = {
    .joystick_horizontal = {&present.joystick_horizontal, read_double, NULL},
    .joystick_vertical = {&present.joystick_vertical, read_double, NULL},
    .joystick_buttons = {present.joystick_buttons, poll_int64, NULL},
    .feedback_horizontal = {&present.feedback_horizontal, read_double, NULL},
    .feedback_vertical = {&present.feedback_vertical, read_double, NULL},
    .control_horizontal = {&present.control_horizontal, NULL, write_double},
    .control_vertical = {&present.control_vertical, NULL, write_double}
};

const csp_environment worn_environment =
    {CSP_MS, worn_environment_start, worn_environment_advance, &present, NULL};
