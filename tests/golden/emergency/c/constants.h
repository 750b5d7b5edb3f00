/* SPDX-License-Identifier: 0BSD */
/* The constants of the program. */
#ifndef CONSTANTS_H
#define CONSTANTS_H

#include "csp_arithmetic.h"

/* Sample period of the spindle's speed loop. */
static const int64_t T = 2 * CSP_MS; /* emergency.csp:2 */

#endif
