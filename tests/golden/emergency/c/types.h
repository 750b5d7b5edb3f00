/* The types of the program. Every value can be assigned: an array is a struct with one member. */
#ifndef TYPES_H
#define TYPES_H

#include <stdbool.h>
#include <stdint.h>

enum button { BUTTON_NONE, BUTTON_START, BUTTON_EMERGENCY };

#endif
