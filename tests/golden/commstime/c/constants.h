/* SPDX-License-Identifier: 0BSD */
/* The constants of the program. */
#ifndef CONSTANTS_H
#define CONSTANTS_H

#include "csp_arithmetic.h"
#include "types.h"

#endif
