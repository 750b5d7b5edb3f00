/* SPDX-License-Identifier: 0BSD */
/* The port for bare Cortex-M: SysTick counts time, and its interrupt comes at the instant for which the program waits; the processor sleeps until
 * then. Messages go to a debugger by semihosting. Needs csp_port_cortex_m_startup.c, or a vector table of your own that calls csp_port_tick at every
 * SysTick. */
#include "csp_port.h"

#include <string.h>

#include "csp_program.h"

/* The clock of the processor in hertz. */
#ifndef CSP_CORTEX_M_CLOCK
#define CSP_CORTEX_M_CLOCK 25000000
#endif

/* The longest sleep in cycles, at most the 24 bits of the counter; then csp_port_alive is called. */
#ifndef CSP_CORTEX_M_LONGEST
#define CSP_CORTEX_M_LONGEST (((CSP_CORTEX_M_CLOCK / 20) < (1 << 24)) ? (CSP_CORTEX_M_CLOCK / 20) : (1 << 24))
#endif

/* The cycles from reading the counter to its first count after a restart. */
#ifndef CSP_CORTEX_M_RESTART
#define CSP_CORTEX_M_RESTART 3
#endif

#define NANOSECONDS INT64_C(1000000000)
#define LONGEST ((uint32_t)CSP_CORTEX_M_LONGEST)

#define INTERRUPT_CONTROL (*(volatile uint32_t *)0xE000ED04U)
#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010U)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014U)
#define SYSTICK_VALUE (*(volatile uint32_t *)0xE000E018U)

enum { SYSTICK_ENABLED = 1, SYSTICK_INTERRUPTS = 2, SYSTICK_OF_PROCESSOR = 4, SYSTICK_PENDING = 1 << 26 };

/* Instants that are as near as this are waited for without sleeping: preparing the sleep would take as long. An interrupt that comes later than it should
 * by less than CLOSE is left as it is, because each restart costs the clock a part of a cycle. */
enum { NEAR = 100, CLOSE = 32 /* cycles */ };

/* Operations of semihosting. */
enum { WRITE_TEXT = 0x04, EXIT = 0x18, APPLICATION_EXIT = 0x20026, RUN_TIME_ERROR = 0x20023 };

const bool csp_port_virtual_time = false;

/* The instant at which the counter last began: seconds since the start, and cycles since then, fewer than those of a second. */
static volatile uint32_t seconds;
static volatile uint32_t cycles;
static volatile uint32_t interval; /* the cycles from there to the next interrupt; the interval after it is the longest one */
static volatile bool woken;        /* since the last wait */

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

/* Moves the instant at which the counter began. */
static void pass(uint32_t passed)
{
    cycles += passed;
    while (cycles >= (uint32_t)CSP_CORTEX_M_CLOCK) {
        cycles -= (uint32_t)CSP_CORTEX_M_CLOCK;
        seconds++;
    }
}

void csp_port_tick(void)
{
    pass(interval);
    interval = LONGEST;
}

/* The counter begins anew when its value is written, and takes the reload at its next cycle; after `wanted` cycles it takes the longest one. */
static void restart(uint32_t wanted)
{
    SYSTICK_RELOAD = wanted - 1U;
    const uint32_t left = SYSTICK_VALUE;
    SYSTICK_VALUE = 0U;
    while (SYSTICK_VALUE <= 1U) {
        /* It has not taken the reload; an emulated one is 1 until then. */
    }
    SYSTICK_RELOAD = LONGEST - 1U;
    pass((interval - left) + (uint32_t)CSP_CORTEX_M_RESTART);
    interval = wanted;
}

void csp_port_start(void)
{
    SYSTICK_CONTROL = 0U;
    seconds = 0U;
    cycles = 0U;
    interval = LONGEST;
    SYSTICK_RELOAD = LONGEST - 1U;
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

__attribute__((weak)) void csp_port_sleep(void)
{
    __asm__ volatile("wfi" : : : "memory");
}

/* The cycles since the counter last began, while interrupts are masked: also those of an interval that has ended, but whose interrupt is pending. */
static uint32_t cycles_passed(void)
{
    uint32_t left = SYSTICK_VALUE;
    if ((INTERRUPT_CONTROL & (uint32_t)SYSTICK_PENDING) != 0U) {
        left = SYSTICK_VALUE;
        return interval + ((left == 0U) ? 0U : (LONGEST - left));
    }
    return (left == 0U) ? 0U : (interval - left);
}

/* Nanoseconds since the start, when these cycles have passed since the counter began. */
static int64_t nanoseconds(uint32_t passed)
{
    const int64_t counted = (int64_t)cycles + (int64_t)passed;
    const int64_t part = ((NANOSECONDS % CSP_CORTEX_M_CLOCK) == 0) ? (counted * (NANOSECONDS / CSP_CORTEX_M_CLOCK))
                                                                   : (counted * NANOSECONDS / CSP_CORTEX_M_CLOCK);
    return ((int64_t)seconds * NANOSECONDS) + part;
}

int64_t csp_port_now(void)
{
    const uint32_t outside = csp_port_enter_critical();
    const int64_t present = nanoseconds(cycles_passed());
    csp_port_leave_critical(outside);
    return present;
}

enum { DIVIDENDS = 1 << 26, DIVISORS = 1 << 12 };

/* By a multiplication, because a Cortex-M0 has no division: exact for any dividend below DIVIDENDS and constant divisor up to DIVISORS. */
static inline uint32_t quotient(uint32_t dividend, uint32_t divisor)
{
    const uint64_t reciprocal = ((UINT64_C(1) << 38U) + (divisor - 1U)) / divisor;
    return (uint32_t)((dividend * reciprocal) >> 38U);
}

/* The cycles in a time, rounded up, so that it is over after them; at most the longest sleep. */
static uint32_t cycles_in(int64_t time)
{
    const int64_t longest = (int64_t)LONGEST * NANOSECONDS / CSP_CORTEX_M_CLOCK;
    if (time >= longest) {
        return LONGEST;
    }
    const int64_t cycle = NANOSECONDS / CSP_CORTEX_M_CLOCK;
    if (((NANOSECONDS % CSP_CORTEX_M_CLOCK) == 0) && (cycle <= (int64_t)DIVISORS) && ((longest + cycle) <= (int64_t)DIVIDENDS)) {
        const uint32_t of_cycle = (uint32_t)cycle;
        return quotient((uint32_t)time + (of_cycle - 1U), of_cycle);
    }
    return (uint32_t)(((time * CSP_CORTEX_M_CLOCK) + NANOSECONDS - 1) / NANOSECONDS);
}

/* Makes the next interrupt come when these cycles have passed since the counter began, unless it comes earlier: the wait is repeated then. Returns false
 * if one of the two is too near. */
static bool wake_at(uint32_t end)
{
    const uint32_t passed = cycles_passed();
    if ((passed + (uint32_t)NEAR) >= interval) {
        return false;
    }
    if ((end + (uint32_t)CLOSE) < interval) {
        if ((passed + (uint32_t)NEAR) >= end) {
            return false;
        }
        restart(end - passed);
    }
    return true;
}

/* Sleeps until the next interrupt: that of the instant, or one that brings an event. Masked interrupts also end the sleep, so an interrupt just before
 * it is not missed. */
void csp_port_wait_until(int64_t instant)
{
    const uint32_t outside = csp_port_enter_critical();
    const uint32_t passed = cycles_passed();
    const int64_t present = nanoseconds(passed);
    if (!woken && (present < instant) && wake_at(passed + cycles_in(instant - present))) {
        csp_port_sleep();
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

#ifdef __ARM_ARCH_6M__
/* What compilers call for the arithmetic of `double`, where it is shorter than in libgcc, whose functions of these names are not linked then. Calls of them
 * appear only when the machine code is generated, and -flto must not drop them before. */
#define USED __attribute__((used))

double __aeabi_dadd(double left, double right);
double __aeabi_dsub(double left, double right);
int __aeabi_dcmpeq(double left, double right);
int __aeabi_dcmplt(double left, double right);
int __aeabi_dcmple(double left, double right);
int __aeabi_dcmpgt(double left, double right);
int __aeabi_dcmpge(double left, double right);

static uint64_t bits_of(double value)
{
    uint64_t bits = 0U;
    (void)memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* The sum with the negated one, which is the same to the last bit. In libgcc it repeats all of the addition, 1.8 kB. */
USED double __aeabi_dsub(double left, double right)
{
    const uint64_t bits = bits_of(right) ^ (UINT64_C(1) << 63U);
    double negated = 0.0;
    (void)memcpy(&negated, &bits, sizeof negated);
    return __aeabi_dadd(left, negated);
}

enum { LESS = 1, EQUAL = 2, GREATER = 4, UNORDERED = 8 };

/* Doubles without their signs are ordered like integers of their bits, and both zeros are equal. */
static unsigned order(double left, double right)
{
    const uint64_t sign = UINT64_C(1) << 63U;
    const uint64_t infinity = UINT64_C(0x7FF) << 52U;
    const uint64_t one = bits_of(left);
    const uint64_t other = bits_of(right);
    if (((one & ~sign) > infinity) || ((other & ~sign) > infinity)) {
        return UNORDERED;
    }
    if ((one == other) || (((one | other) & ~sign) == 0U)) {
        return EQUAL;
    }
    if (((one ^ other) & sign) != 0U) {
        return ((one & sign) != 0U) ? LESS : GREATER;
    }
    return ((one < other) != ((one & sign) != 0U)) ? LESS : GREATER;
}

USED int __aeabi_dcmpeq(double left, double right)
{
    return (order(left, right) == EQUAL) ? 1 : 0;
}

USED int __aeabi_dcmplt(double left, double right)
{
    return (order(left, right) == LESS) ? 1 : 0;
}

USED int __aeabi_dcmple(double left, double right)
{
    return ((order(left, right) & (LESS | EQUAL)) != 0U) ? 1 : 0;
}

USED int __aeabi_dcmpgt(double left, double right)
{
    return (order(left, right) == GREATER) ? 1 : 0;
}

USED int __aeabi_dcmpge(double left, double right)
{
    return ((order(left, right) & (GREATER | EQUAL)) != 0U) ? 1 : 0;
}
#endif
