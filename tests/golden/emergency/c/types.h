/* SPDX-License-Identifier: 0BSD */
/* The types of the program, and how their values are compared and tested. */
#ifndef TYPES_H
#define TYPES_H

#include <stdbool.h>
#include <stdint.h>

#include "csp_core.h"
#include "emergency_types.h"

#endif
