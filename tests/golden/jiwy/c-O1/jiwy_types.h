/* SPDX-License-Identifier: 0BSD
 *
 * The types of values: an array is a struct with one member, so it can be assigned.
 */
#ifndef JIWY_TYPES_H
#define JIWY_TYPES_H

#include <stdbool.h>
#include <stdint.h>

struct jiwy_servo_gains {
    double kp;
    int64_t tauD; /* In nanoseconds. */
    double beta;
    int64_t tauI; /* In nanoseconds. */
    double friction; /* In V. */
    double tolerance; /* In rad. */
};

/* The parameters of the program, which may change while it runs. */
struct jiwy_parameters {
    /* Servo of the horizontal joint; the first four are published. */
    struct jiwy_servo_gains panGains;
    struct jiwy_servo_gains tiltGains; /* Servo of the vertical joint. */
};

#endif
