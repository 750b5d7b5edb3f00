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
    int64_t tauD;
    double beta;
    int64_t tauI;
    double friction;
    double tolerance;
};

#endif
