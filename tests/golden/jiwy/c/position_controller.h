/* SPDX-License-Identifier: 0BSD */
/* Position servo of one joint. The set-point counts from the centre between the end stops, 1 being
 * `reach`; `reference` is the angle that this means. The voltage for the friction is added in the
 * direction in which the profile moves. `stop` tells that the joint has stood where it should for
 * `dwell`.
 *
 * Source: laws.csp:56
 */
#ifndef POSITION_CONTROLLER_H
#define POSITION_CONTROLLER_H

#include "csp_core.h"
#include "types.h"

struct position_controller {
    /* Inputs. */
    double leftmax;
    double rightmax;
    double feedback;
    double setpoint;
    /* Outputs. */
    double control;
    double reference;
    bool stop;
    /* States. */
    bool profile_moving;
    double profile_last;
    double pid_e1;
    double pid_ud;
    double pid_ui;
    double arrived;
    /* Parameters and what follows from them. */
    const struct jiwy_servo_gains *gains;
    double reach;
    double rate;
    double smoothing;
    double dwell;
    double margin;
    double sample;
};

/* Before the first run; durations are in nanoseconds. */
void position_controller_initialize(struct position_controller *self,
    const struct jiwy_servo_gains *gains, double reach, double rate, int64_t smoothing,
    int64_t dwell, double margin, double sample);
/* Puts the states back to their initial values. */
void position_controller_reset(struct position_controller *self);
/* One run, from inputs to outputs and next states; csp_faulted says whether it failed. */
void position_controller_calculate(csp_kernel *csp, struct position_controller *self);

#endif
