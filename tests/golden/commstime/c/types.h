/* The types of the program. Every value can be assigned: an array is a struct with one member. */
#ifndef TYPES_H
#define TYPES_H

#include <stdbool.h>
#include <stdint.h>

#include "csp_core.h"

/* The exceptions that the program declares. */
enum { EXCEPTION_FINISHED = CSP_FIRST_EXCEPTION };

#endif
