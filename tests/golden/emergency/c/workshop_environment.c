/* SPDX-License-Identifier: 0BSD */
/* See workshop_environment.h. */
#include "workshop_environment.h"

#include "csp_arithmetic.h"
#include "types.h"

static const double wheel_inertia = 0.0002; /* emergency.csp:43 */

static struct workshop_environment present;

static bool poll_emergency_button(void *device, void *value)
{
    /* The present and the last value: an event is a change. */
    enum emergency_button *const signal = device;
    const bool changed = signal[0] != signal[1];
    signal[1] = signal[0];
    *(enum emergency_button *)value = signal[0];
    return changed;
}

static bool read_double(void *device, void *value)
{
    *(double *)value = *(const double *)device;
    return true;
}

static void write_double(void *device, const void *value)
{
    *(double *)device = *(const double *)value;
}

static void write_bool(void *device, const void *value)
{
    *(bool *)device = *(const bool *)value;
}

static inline double workshop_environment_slopes(double wheel_w, double wheel_voltage,
    bool wheel_brake)
{
    const double wheel_motor = 0.05 * (wheel_voltage - 0.05 * wheel_w) / 1.0; /* emergency.csp:49 */
    const double wheel_braked = wheel_brake ? 0.002 * wheel_w : 0.0; /* emergency.csp:50 */
    const double slope = (wheel_motor - wheel_braked) / wheel_inertia;
    return slope;
}

static bool workshop_environment_evaluate(csp_kernel *csp, struct workshop_environment *self)
{
    (void)csp;
    const double time = csp_seconds(self->now);
    const double wheel_speed = self->wheel_w; /* emergency.csp:52 */
    /* emergency.csp:59 */
    const enum emergency_button operator_button = (time < 0.1)
        ? EMERGENCY_BUTTON_NONE
        : ((time < 0.9) ? EMERGENCY_BUTTON_START : EMERGENCY_BUTTON_EMERGENCY);
    self->panel[0] = operator_button; /* emergency.csp:66 */
    self->feedback = wheel_speed; /* emergency.csp:67 */
    return true;
}

static bool workshop_environment_start(csp_kernel *csp, void *state)
{
    struct workshop_environment *const self = state;
    self->now = 0;
    self->wheel_w = 0.0; /* emergency.csp:48 */
    (void)workshop_environment_evaluate(csp, self);
    self->panel[1] = self->panel[0];
    return !csp_faulted(csp);
}

static bool workshop_environment_advance(csp_kernel *csp, void *state, int64_t now)
{
    struct workshop_environment *const self = state;
    double wheel_w = self->wheel_w;
    const double wheel_voltage = self->control; /* emergency.csp:68 */
    const bool wheel_brake = self->brake; /* emergency.csp:69 */
    const double h = csp_seconds(now - self->now);
    const double half = h / 2.0;
    const double sixth = h / 6.0;
    const double k1 = workshop_environment_slopes(wheel_w, wheel_voltage, wheel_brake);
    const double k2 = workshop_environment_slopes(wheel_w + half * k1, wheel_voltage, wheel_brake);
    const double k3 = workshop_environment_slopes(wheel_w + half * k2, wheel_voltage, wheel_brake);
    const double k4 = workshop_environment_slopes(wheel_w + h * k3, wheel_voltage, wheel_brake);
    wheel_w += sixth * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    if (!csp_is_finite(wheel_w)) {
        csp_finite_at(csp, wheel_w, "emergency.csp:51");
        if (csp_faulted_at(csp, "emergency.csp:51")) {
            return false;
        }
    }
    self->wheel_w = wheel_w;
    self->now = now;
    return workshop_environment_evaluate(csp, self);
}

const struct network_drivers workshop_environment_drivers = {
    .panel = {present.panel, poll_emergency_button, NULL},
    .feedback = {&present.feedback, read_double, NULL},
    .control = {&present.control, NULL, write_double},
    .brake = {&present.brake, NULL, write_bool},
    .halted = {&present.halted, NULL, write_bool}
};

const csp_environment workshop_environment =
    {2 * CSP_MS, workshop_environment_start, workshop_environment_advance, &present, NULL};
