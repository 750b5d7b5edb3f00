/* SPDX-License-Identifier: 0BSD
 *
 * What the loop needs of a processor.
 */
#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>
#include <stdint.h>

void board_start(void);
/* Nanoseconds since the start. */
int64_t board_now(void);
/* Sleeps until the instant, or until board_wake, or less. */
void board_sleep_until(int64_t instant);
/* May be called by interrupt handlers. */
void board_wake(void);
/* May be nested: the result of the first is passed to the second. */
uint32_t board_disable_interrupts(void);
void board_restore_interrupts(uint32_t before);
/* From now on the interrupt of the button, which may be pending, calls on_button. */
void board_enable_button(void);
/* Makes that interrupt come. */
void board_press_button(void);
void on_button(void);
/* Called after a fault of the processor; the board stops when it returns. */
void on_fault(void);
void board_write(const char *text);

#endif
