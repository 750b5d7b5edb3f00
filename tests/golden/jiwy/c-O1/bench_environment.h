/* SPDX-License-Identifier: 0BSD */
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
    double pan_mass;
    double pan_stiction;
    double tilt_mass;
    double tilt_stiction;
};

/* One of them, and what it is behind the ports of the program. */
extern const csp_environment bench_environment;
extern const struct network_drivers bench_environment_drivers;

#endif
