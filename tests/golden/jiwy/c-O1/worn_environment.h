/* SPDX-License-Identifier: 0BSD */
/* A worn machine, its friction up by 30 %, switched on near its end stops, in the hand of an
 * impatient operator.
 *
 * Source: jiwy.csp:183
 */
#ifndef WORN_ENVIRONMENT_H
#define WORN_ENVIRONMENT_H

#include "network.h"

/* The state of the plant and the operator, with their signals. */
struct worn_environment {
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
extern const csp_environment worn_environment;
extern const struct network_drivers worn_environment_drivers;

#endif
