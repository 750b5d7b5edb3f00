/* SPDX-License-Identifier: 0BSD
 *
 * A RISC-V processor with the usual timer (CLINT), as QEMU's machine virt: the timer interrupt comes at the next
 * instant, and the processor sleeps by wfi until then.
 */
#include "board.h"

#include <stddef.h>
#include <string.h>

/* Defined by the linker script. */
extern char csp_zero_begin[];
extern char csp_zero_end[];

#define SOFTWARE_INTERRUPT (*(volatile uint32_t *)0x02000000U)
#define COMPARE_LOW (*(volatile uint32_t *)0x02004000U)
#define COMPARE_HIGH (*(volatile uint32_t *)0x02004004U)
#define TIME_LOW (*(volatile uint32_t *)0x0200BFF8U)
#define TIME_HIGH (*(volatile uint32_t *)0x0200BFFCU)
#define SERIAL_DATA (*(volatile uint8_t *)0x10000000U)
#define FINISHER (*(volatile uint32_t *)0x00100000U)

enum { NANOSECONDS_IN_TICK = 100 }; /* the timer counts at 10 MHz */
enum { OF_SOFTWARE = 1U << 3U, OF_TIMER = 1U << 7U, ENABLED = 1U << 3U };
enum { SUCCESS = 0x5555, FAILURE = 0x13333 };

/* An instruction for control registers, for which assemblers ask by name. */
#define CONTROL(text) ".option push\n\t.option arch, +zicsr\n\t" text "\n\t.option pop"

static volatile bool woken; /* since the last sleep */

int main(void);
void csp_reset(void);
/* Called in assembly alone, which -flto does not see. */
void board_prepare(void) __attribute__((used));

/* Called by the entry below for every trap. */
__attribute__((interrupt("machine"), aligned(4))) static void on_trap(void)
{
    uint32_t cause = 0U;
    __asm__ volatile(CONTROL("csrr %0, mcause") : "=r"(cause));
    if (cause == 0x80000003U) {
        SOFTWARE_INTERRUPT = 0U;
        on_button();
    } else if (cause == 0x80000007U) {
        COMPARE_HIGH = UINT32_MAX; /* it has come */
    } else {
        on_fault();
        board_write("fault of the processor\n");
        FINISHER = FAILURE;
        for (;;) {
            /* Without that register, a return would repeat the instruction that has failed. */
        }
    }
}

__attribute__((naked, section(".start"))) void csp_reset(void)
{
    __asm__ volatile("la tp, csp_thread_begin\n\t"
                     "la sp, csp_stack_end\n\t"
                     "j board_prepare");
}

void board_prepare(void)
{
    (void)memset(csp_zero_begin, 0, (size_t)(csp_zero_end - csp_zero_begin));
    FINISHER = (main() == 0) ? SUCCESS : FAILURE;
    for (;;) {
        /* The machine is off. */
    }
}

static uint64_t ticks(void)
{
    uint32_t high = 0U;
    uint32_t low = 0U;
    do {
        high = TIME_HIGH;
        low = TIME_LOW;
    } while (high != TIME_HIGH);
    return ((uint64_t)high << 32U) | low;
}

static uint64_t started;

void board_start(void)
{
    started = ticks();
    COMPARE_HIGH = UINT32_MAX;
    __asm__ volatile(CONTROL("csrw mtvec, %0") : : "r"(&on_trap));
    __asm__ volatile(CONTROL("csrs mie, %0") : : "r"(OF_TIMER));
    board_restore_interrupts(ENABLED);
}

void board_enable_button(void)
{
    __asm__ volatile(CONTROL("csrs mie, %0") : : "r"(OF_SOFTWARE));
}

int64_t board_now(void)
{
    return (int64_t)(ticks() - started) * NANOSECONDS_IN_TICK;
}

void board_sleep_until(int64_t instant)
{
    const uint32_t before = board_disable_interrupts();
    if (!woken && (board_now() < instant)) {
        const uint64_t end = (instant == INT64_MAX)
            ? UINT64_MAX
            : (started + (((uint64_t)instant + NANOSECONDS_IN_TICK - 1U) / NANOSECONDS_IN_TICK));
        COMPARE_HIGH = UINT32_MAX; /* no interrupt between the two halves */
        COMPARE_LOW = (uint32_t)end;
        COMPARE_HIGH = (uint32_t)(end >> 32U);
        __asm__ volatile("wfi" : : : "memory"); /* which disabled interrupts end, too */
    }
    woken = false;
    board_restore_interrupts(before);
}

void board_wake(void)
{
    woken = true;
}

uint32_t board_disable_interrupts(void)
{
    uint32_t before = 0U;
    __asm__ volatile(CONTROL("csrrc %0, mstatus, %1") : "=r"(before) : "r"(ENABLED) : "memory");
    return before & ENABLED;
}

void board_restore_interrupts(uint32_t before)
{
    __asm__ volatile(CONTROL("csrs mstatus, %0") : : "r"(before) : "memory");
}

void board_press_button(void)
{
    SOFTWARE_INTERRUPT = 1U;
}

void board_write(const char *text)
{
    for (const char *at = text; *at != '\0'; at++) {
        SERIAL_DATA = (uint8_t)*at;
    }
}
