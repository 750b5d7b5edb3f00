/* SPDX-License-Identifier: 0BSD */
/* Proportional law with the voltage that the speed induces added.
 *
 * Source: emergency.csp:8
 */
#ifndef SPINDLE_CONTROLLER_H
#define SPINDLE_CONTROLLER_H

#include "csp_core.h"

struct spindle_controller {
    /* Inputs. */
    double feedback;
    /* Outputs. */
    double control;
    /* Parameters and what follows from them. */
    double speed;
};

/* Before the first run. */
void spindle_controller_initialize(struct spindle_controller *self, double speed);
/* Puts the states back to their initial values. */
void spindle_controller_reset(struct spindle_controller *self);
/* One run, from inputs to outputs and next states; csp_faulted says whether it failed. */
void spindle_controller_calculate(csp_kernel *csp, struct spindle_controller *self);

#endif
