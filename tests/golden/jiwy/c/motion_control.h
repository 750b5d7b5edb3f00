/* SPDX-License-Identifier: 0BSD */
/* Servo that follows the joystick until the stop button is pressed, then releases the motor.
 *
 * Source: jiwy.csp:46
 */
#ifndef MOTION_CONTROL_H
#define MOTION_CONTROL_H

#include "csp.h"
#include "types.h"
#include "position_controller.h"

/* What the ports are connected to. */
struct motion_control_ports {
    const double *leftmax;
    const csp_written *leftmax_written;
    const double *rightmax;
    const csp_written *rightmax_written;
    csp_sampled_input *feedback;
    csp_sampled_input *joystick_axis;
    csp_event_input *joystick_buttons;
    csp_latched_output *control;
};

struct motion_control {
    csp_process process;
    csp_ends samples;
    const double *leftmax;
    const csp_written *leftmax_written;
    const double *rightmax;
    const csp_written *rightmax_written;
    csp_latched_output *control;
    csp_event_end *joystick_buttons;
    /* if it has one of its own */
    csp_event_end joystick_buttons_latch;
    csp_sampled_end feedback;
    csp_sampled_end joystick_axis;
    int64_t status;
    bool failed;
    double reference;
    struct position_controller servo;
    struct {
        csp_alternative alternative;
        csp_guard guards[2];
    } choice;
    union {
        double control;
    } sent;
    csp_offers offers;
    csp_offer offers_made[2];
};

/* Before the program starts. */
void motion_control_initialize(struct motion_control *self, csp_numbers *numbers,
    const struct motion_control_ports *ports, int64_t T, const struct jiwy_servo_gains *gains,
    double reach);

#endif
