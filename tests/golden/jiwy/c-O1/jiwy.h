/* SPDX-License-Identifier: 0BSD */
/* The pan-and-tilt end-effector: both joints at the same time, each at its own sample period.
 *
 * Source: jiwy.csp:134
 */
#ifndef JIWY_H
#define JIWY_H

#include "csp.h"
#include "types.h"
#include "joint_control.h"

/* What the ports are connected to. */
struct jiwy_ports {
    csp_sampled_input *joystick_horizontal;
    csp_sampled_input *joystick_vertical;
    csp_event_input *joystick_buttons;
    csp_sampled_input *feedback_horizontal;
    csp_sampled_input *feedback_vertical;
    csp_latched_output *control_horizontal;
    csp_latched_output *control_vertical;
};

struct jiwy {
    csp_process process;
    struct joint_control horizontal;
    struct joint_control vertical;
    csp_parallel parallel;
};

/* Before the program starts. */
void jiwy_initialize(struct jiwy *self, csp_numbers *numbers, const struct jiwy_ports *ports,
    const struct jiwy_servo_gains *panGains, const struct jiwy_servo_gains *tiltGains);

#endif
