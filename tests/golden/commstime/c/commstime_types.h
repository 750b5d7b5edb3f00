/* SPDX-License-Identifier: 0BSD
 *
 * The types of values: an array is a struct with one member, so it can be assigned.
 */
#ifndef COMMSTIME_TYPES_H
#define COMMSTIME_TYPES_H

#include <stdbool.h>
#include <stdint.h>

#endif
