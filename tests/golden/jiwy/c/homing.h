/* SPDX-License-Identifier: 0BSD */
/* Servo back to the centre; there, or where its patience ends, the motor is released.
 *
 * Source: jiwy.csp:76
 */
#ifndef HOMING_H
#define HOMING_H

#include "csp.h"
#include "types.h"
#include "position_controller.h"

/* What the ports are connected to. */
struct homing_ports {
    const double *leftmax;
    const csp_written *leftmax_written;
    const double *rightmax;
    const csp_written *rightmax_written;
    csp_sampled_input *feedback;
    csp_latched_output *control;
};

struct homing {
    csp_process process;
    csp_ends samples;
    int64_t patience;
    const double *leftmax;
    const csp_written *leftmax_written;
    const double *rightmax;
    const csp_written *rightmax_written;
    csp_latched_output *control;
    csp_sampled_end feedback;
    /* The centre. */
    double zero;
    bool failed;
    bool stop;
    double reference;
    struct position_controller servo;
    union {
        double control;
    } sent;
    csp_process repeat_servo_branch;
    csp_interrupt interrupt_repeat_servo;
};

/* Before the program starts. */
void homing_initialize(struct homing *self, csp_numbers *numbers, const struct homing_ports *ports,
    int64_t T, const struct jiwy_servo_gains *gains, int64_t patience);

#endif
