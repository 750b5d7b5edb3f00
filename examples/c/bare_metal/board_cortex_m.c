/* SPDX-License-Identifier: 0BSD
 *
 * A Cortex-M, by the port that comes with the program: SysTick, sleep, and the start after reset.
 */
#include "board.h"

#include "csp_port.h"

#define ENABLED_INTERRUPTS (*(volatile uint32_t *)0xE000E100U)
#define PENDING_INTERRUPTS (*(volatile uint32_t *)0xE000E200U)

enum { BUTTON = 1U << 20U }; /* interrupt 20, which no device of the emulated boards has */

extern void (*const interrupts[32])(void);
/* All of the processor: one without a handler is a fault, which releases the outputs. */
void (*const interrupts[32])(void) __attribute__((section(".vectors.devices"), used)) = {[20] = on_button};

void board_start(void)
{
    csp_port_start();
}

void board_enable_button(void)
{
    ENABLED_INTERRUPTS = BUTTON;
}

void csp_port_release(void)
{
    on_fault();
}

int64_t board_now(void)
{
    return csp_port_now();
}

void board_sleep_until(int64_t instant)
{
    csp_port_wait_until(instant);
}

void board_wake(void)
{
    csp_port_wake();
}

uint32_t board_disable_interrupts(void)
{
    return csp_port_enter_critical();
}

void board_restore_interrupts(uint32_t before)
{
    csp_port_leave_critical(before);
}

void board_press_button(void)
{
    PENDING_INTERRUPTS = BUTTON;
}

void board_write(const char *text)
{
    csp_port_write(text);
}
