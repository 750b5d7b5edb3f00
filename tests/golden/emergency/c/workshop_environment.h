/* SPDX-License-Identifier: 0BSD */
/* The environment Workshop.
 *
 * Source: emergency.csp:62
 */
#ifndef WORKSHOP_ENVIRONMENT_H
#define WORKSHOP_ENVIRONMENT_H

#include "network.h"

/* The state of the plant and the operator, with their signals. */
struct workshop_environment {
    int64_t now; /* in nanoseconds */
    enum emergency_button panel[2]; /* present and last */
    double feedback;
    double control;
    bool brake;
    bool halted;
    double wheel_w;
};

/* One of them, and what it is behind the ports of the program. */
extern const csp_environment workshop_environment;
extern const struct network_drivers workshop_environment_drivers;

#endif
