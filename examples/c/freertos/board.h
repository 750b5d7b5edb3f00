/* SPDX-License-Identifier: 0BSD
 *
 * What the task needs of your board.
 */
#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>

double board_level(void);
void board_set_opening(double opening);
void board_set_lamp(bool on);
/* The run is over, and the outputs have their safe values. */
void board_ended(const char *why);

#endif
