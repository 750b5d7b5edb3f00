/* SPDX-License-Identifier: 0BSD
 *
 * What the thread needs of your board.
 */
#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>

double board_level(void);
void board_set_opening(double opening);
void board_set_lamp(bool on);
/* From now on the interrupt handler of the button may call on_button. */
void board_enable_button(void);
void on_button(void);

#endif
