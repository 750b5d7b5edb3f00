/* SPDX-License-Identifier: 0BSD */
/* The types of the program, and how their values are compared and tested. */
#ifndef TYPES_H
#define TYPES_H

#include <stdbool.h>
#include <stdint.h>

#include "csp_core.h"
#include "commstime_types.h"

#include "csp_core.h"

/* The exceptions that the program declares. */
enum { EXCEPTION_FINISHED = CSP_FIRST_EXCEPTION };

#endif
