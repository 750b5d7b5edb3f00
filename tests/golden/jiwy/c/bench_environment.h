/* Both joints stand somewhere between their end stops; the operator moves the stick, presses the
 * button, lets go.
 *
 * Source: jiwy.csp:162
 */
#ifndef BENCH_ENVIRONMENT_H
#define BENCH_ENVIRONMENT_H

#include "network.h"

/* The state of the plant and the operator, with their signals. */
struct bench_environment {
    int64_t now; /* in nanoseconds */
    double joystick_horizontal;
    double joystick_vertical;
    int64_t joystick_buttons[2]; /* present and last */
    double feedback_horizontal;
    double feedback_vertical;
    double control_horizontal;
    double control_vertical;
    double pan_angle;
    double pan_speed;
    double tilt_angle;
    double tilt_speed;
    double pan_start;
    double pan_left;
    double pan_damper;
    double pan_right;
    double pan_inertia;
    double pan_mass;
    double pan_viscous;
    double pan_gravity;
    double pan_coulomb;
    double pan_stiction;
    double pan_creep;
    double pan_settling;
    double tilt_start;
    double tilt_left;
    double tilt_damper;
    double tilt_right;
    double tilt_inertia;
    double tilt_mass;
    double tilt_viscous;
    double tilt_gravity;
    double tilt_coulomb;
    double tilt_stiction;
    double tilt_creep;
    double tilt_settling;
};

/* One of them, and what it is behind the ports of the program. */
extern const csp_environment bench_environment;
extern const struct network_drivers bench_environment_drivers;

#endif
