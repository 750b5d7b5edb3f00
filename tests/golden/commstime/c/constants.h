/* SPDX-License-Identifier: 0BSD */
/* The constants of the program. */
#ifndef CONSTANTS_H
#define CONSTANTS_H

#include "csp_core.h"

#endif
