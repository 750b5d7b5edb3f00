/* SPDX-License-Identifier: 0BSD */
/* Turns one joint at constant speed until it meets its end stop, and remembers where that was.
 *
 * Source: jiwy.csp:23
 */
#ifndef ALIGN_H
#define ALIGN_H

#include "csp.h"
#include "velocity_controller.h"

/* What the ports are connected to. */
struct align_ports {
    csp_sampled_input *feedback;
    csp_latched_output *control;
    double *max;
    csp_written *max_written;
};

struct align {
    csp_process process;
    csp_ends samples;
    int64_t patience;
    csp_latched_output *control;
    double *max;
    csp_written *max_written;
    csp_sampled_end feedback;
    bool failed;
    bool stop;
    struct velocity_controller velocity;
    union {
        double control;
    } sent;
    csp_process repeat_velocity_branch;
    csp_interrupt interrupt_repeat_velocity;
};

/* Before the program starts. */
void align_initialize(struct align *self, csp_numbers *numbers, const struct align_ports *ports,
    int64_t T, double speed, double kp, double ki, int64_t patience);

#endif
