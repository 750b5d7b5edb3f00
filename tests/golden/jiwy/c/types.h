/* SPDX-License-Identifier: 0BSD */
/* The types of the program, and how their values are compared and tested. */
#ifndef TYPES_H
#define TYPES_H

#include <stdbool.h>
#include <stdint.h>

#include "csp_core.h"
#include "jiwy_types.h"

#include "csp_arithmetic.h"

/* The exceptions that the program declares. */
enum { EXCEPTION_MODE_FAILED = CSP_FIRST_EXCEPTION };

static inline void jiwy_servo_gains_finite(csp_kernel *csp, struct jiwy_servo_gains value,
    const char *port)
{
    csp_finite(csp, value.kp, port);
    csp_finite(csp, value.beta, port);
    csp_finite(csp, value.friction, port);
    csp_finite(csp, value.tolerance, port);
}

#endif
