/* SPDX-License-Identifier: 0BSD */
/* Runs the spindle until the emergency button is pressed: whatever the law is doing is abandoned
 * and the brake is applied. That it halted is announced when it stands still.
 *
 * Source: emergency.csp:17
 */
#ifndef SPINDLE_H
#define SPINDLE_H

#include "csp.h"
#include "types.h"
#include "spindle_controller.h"

/* What the ports are connected to. */
struct spindle_ports {
    csp_event_input *panel;
    csp_sampled_input *feedback;
    csp_latched_output *control;
    csp_latched_output *brake;
    csp_direct_output *halted;
};

struct spindle {
    csp_process process;
    csp_ends samples;
    csp_latched_output *control;
    csp_latched_output *brake;
    csp_direct_output *halted;
    csp_event_end *panel;
    /* if it has one of its own */
    csp_event_end panel_latch;
    csp_sampled_end feedback;
    enum emergency_button button;
    double speed;
    struct spindle_controller law;
    union {
        bool brake;
        double control;
        bool halted;
    } sent;
    csp_process repeat_law_branch;
    csp_interrupt interrupt_repeat_law;
};

/* Before the program starts. */
void spindle_initialize(struct spindle *self, csp_numbers *numbers,
    const struct spindle_ports *ports);

#endif
