/* SPDX-License-Identifier: 0BSD */
/* One joint through its four modes.
 *
 * Source: jiwy.csp:104
 */
#ifndef JOINT_CONTROL_H
#define JOINT_CONTROL_H

#include "csp.h"
#include "types.h"
#include "align.h"
#include "motion_control.h"
#include "homing.h"

/* What the ports are connected to. */
struct joint_control_ports {
    csp_sampled_input *feedback;
    csp_sampled_input *joystick_axis;
    csp_event_input *joystick_buttons;
    csp_latched_output *control;
};

struct joint_control {
    csp_process process;
    double leftmax;
    csp_written leftmax_written;
    double rightmax;
    csp_written rightmax_written;
    struct align alignL;
    struct align alignR;
    struct motion_control motionControl;
    struct homing homing;
};

/* Before the program starts. */
void joint_control_initialize(struct joint_control *self, csp_numbers *numbers,
    const struct joint_control_ports *ports, int64_t T, const struct jiwy_servo_gains *gains,
    double reach, double alignSpeed, double alignKp, double alignKi);

#endif
