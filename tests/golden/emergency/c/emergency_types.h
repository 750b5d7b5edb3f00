/* SPDX-License-Identifier: 0BSD
 *
 * The types of values: an array is a struct with one member, so it can be assigned.
 */
#ifndef EMERGENCY_TYPES_H
#define EMERGENCY_TYPES_H

#include <stdbool.h>
#include <stdint.h>

enum emergency_button { EMERGENCY_BUTTON_NONE, EMERGENCY_BUTTON_START, EMERGENCY_BUTTON_EMERGENCY };

#endif
