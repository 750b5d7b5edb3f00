/* SPDX-License-Identifier: 0BSD */
/* Constant speed: PI on the filtered difference of the encoder, its output limited, so that it
 * presses gently on the end stop. The end stop is the joint standing still for `dwell` although
 * the controller drives with more than `effort`; `max` is where the joint is.
 *
 * Source: laws.csp:88
 */
#ifndef VELOCITY_CONTROLLER_H
#define VELOCITY_CONTROLLER_H

#include "csp_core.h"

struct velocity_controller {
    /* Inputs. */
    double feedback;
    /* Outputs. */
    double control;
    double max;
    bool stop;
    /* States. */
    bool moving;
    double last;
    double filtered;
    double ui;
    double pressed;
    /* Parameters and what follows from them. */
    double speed;
    double kp;
    double ki;
    double pressure;
    double effort;
    double filter;
    double dwell;
    double sample;
};

/* Before the first run; durations are in nanoseconds. */
void velocity_controller_initialize(struct velocity_controller *self, double speed, double kp,
    double ki, double pressure, double effort, int64_t filter, int64_t dwell, double sample);
/* Puts the states back to their initial values. */
void velocity_controller_reset(struct velocity_controller *self);
/* One run, from inputs to outputs and next states; csp_faulted says whether it failed. */
void velocity_controller_calculate(csp_kernel *csp, struct velocity_controller *self);

#endif
