/* The port for bare Cortex-M: SysTick counts time, the processor sleeps until the next interrupt, messages go to a debugger by
 * semihosting. Needs csp_port_cortex_m_startup.c, or a vector table of your own that calls csp_port_tick at every SysTick. */
#include "csp_port.h"

#include "csp_program.h"

/* The clock of the processor in hertz, and the number of its cycles in a tick: 1 ms unless defined otherwise. */
#ifndef CSP_CORTEX_M_CLOCK
#define CSP_CORTEX_M_CLOCK 25000000
#endif
#ifndef CSP_CORTEX_M_CYCLES
#define CSP_CORTEX_M_CYCLES (CSP_CORTEX_M_CLOCK / 1000)
#endif

#define NANOSECONDS INT64_C(1000000000)
#define TICK (NANOSECONDS * CSP_CORTEX_M_CYCLES / CSP_CORTEX_M_CLOCK)

#define INTERRUPT_CONTROL (*(volatile uint32_t *)0xE000ED04U)
#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010U)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014U)
#define SYSTICK_VALUE (*(volatile uint32_t *)0xE000E018U)

enum { SYSTICK_ENABLED = 1, SYSTICK_INTERRUPTS = 2, SYSTICK_OF_PROCESSOR = 4, SYSTICK_PENDING = 1 << 26 };

/* Operations of semihosting. */
enum { WRITE_TEXT = 0x04, EXIT = 0x18, APPLICATION_EXIT = 0x20026, RUN_TIME_ERROR = 0x20023 };

const bool csp_port_virtual_time = false;

static volatile uint64_t ticks;
static volatile bool woken; /* since the last wait */

static uintptr_t semihost(uintptr_t operation, uintptr_t argument)
{
    register uintptr_t result __asm__("r0") = operation;
    register uintptr_t value __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(result) : "r"(value) : "memory");
    return result;
}

void csp_port_write(const char *text)
{
    (void)semihost(WRITE_TEXT, (uintptr_t)text);
}

void csp_port_exit(bool successful)
{
    (void)semihost(EXIT, successful ? (uintptr_t)APPLICATION_EXIT : (uintptr_t)RUN_TIME_ERROR);
    for (;;) {
        __asm__ volatile("wfi");
    }
}

void csp_port_tick(void)
{
    ticks++;
}

void csp_port_start(void)
{
    ticks = 0U;
    SYSTICK_RELOAD = (uint32_t)CSP_CORTEX_M_CYCLES - 1U;
    SYSTICK_VALUE = 0U;
    SYSTICK_CONTROL = (uint32_t)SYSTICK_ENABLED | (uint32_t)SYSTICK_INTERRUPTS | (uint32_t)SYSTICK_OF_PROCESSOR;
}

void csp_port_finish(struct csp_kernel *csp)
{
    (void)csp;
    SYSTICK_CONTROL = 0U;
}

__attribute__((weak)) void csp_port_alive(void)
{
}

/* Reads the counter again if a tick occurred in between. While interrupts are masked, a pending tick has not been counted yet. */
int64_t csp_port_now(void)
{
    uint64_t counted = 0U;
    uint32_t left = 0U;
    uint32_t control = 0U;
    do {
        counted = ticks;
        left = SYSTICK_VALUE;
        control = INTERRUPT_CONTROL;
    } while ((counted != ticks) || (SYSTICK_VALUE > left));
    if ((control & (uint32_t)SYSTICK_PENDING) != 0U) {
        counted++;
    }
    const int64_t cycles = (left == 0U) ? 0 : ((int64_t)CSP_CORTEX_M_CYCLES - (int64_t)left);
    return ((int64_t)counted * TICK) + (cycles * TICK / CSP_CORTEX_M_CYCLES);
}

/* Sleeps until the next interrupt: a tick, or one that brings an event. Masked interrupts also end the sleep, so an interrupt just before it is
 * not missed. */
void csp_port_wait_until(int64_t instant)
{
    const uint32_t outside = csp_port_enter_critical();
    if (!woken && (csp_port_now() < instant)) {
        __asm__ volatile("wfi" : : : "memory");
    }
    woken = false;
    csp_port_leave_critical(outside);
}

void csp_port_wake(void)
{
    woken = true;
}

void csp_port_met(int64_t instant)
{
    (void)instant;
}

uint32_t csp_port_enter_critical(void)
{
    uint32_t masked = 0U;
    __asm__ volatile("mrs %0, primask\n\tcpsid i" : "=r"(masked) : : "memory");
    return masked;
}

void csp_port_leave_critical(uint32_t outside)
{
    __asm__ volatile("msr primask, %0" : : "r"(outside) : "memory");
}

void csp_port_fatal(const char *message)
{
    csp_port_write(message);
    csp_port_write("\n");
    csp_port_exit(false);
}
