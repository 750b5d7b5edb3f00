/* One thread on a kernel whose ticks pass while it waits; an interrupt presses the button, between two ticks of the program. */
#include <assert.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <zephyr/fatal.h>
#include <zephyr/irq.h>
#include <zephyr/kernel.h>

#include "board.h"

enum { PRESSED = 50350 /* ticks */, TICK = 10000 /* ns */ };

extern const k_thread_entry_t tank_thread_entry;
extern const size_t tank_thread_stack;

static int64_t uptime = 123;
static bool locked;
static bool enabled;
static double level = 0.2;
static double opening;
static bool fails;
static int samples;

int k_sem_take(struct k_sem *semaphore, k_timeout_t timeout)
{
    const int64_t until = (timeout.ticks == -1) ? INT64_MAX : (-2 - timeout.ticks);
    assert(!locked);
    while ((semaphore->count == 0U) && (uptime < until)) {
        uptime++;
        if (enabled && (uptime == PRESSED)) {
            on_button();
        }
    }
    if (semaphore->count == 0U) {
        return -11;
    }
    semaphore->count--;
    return 0;
}

void k_sem_give(struct k_sem *semaphore)
{
    semaphore->count = (semaphore->count < semaphore->limit) ? (semaphore->count + 1U) : semaphore->limit;
}

int64_t k_uptime_ticks(void)
{
    return uptime;
}

uint64_t k_ns_to_ticks_ceil64(uint64_t nanoseconds)
{
    return (nanoseconds + TICK - 1U) / TICK;
}

uint64_t k_ticks_to_ns_floor64(uint64_t ticks)
{
    return ticks * TICK;
}

unsigned int irq_lock(void)
{
    const unsigned int before = locked ? 1U : 0U;
    locked = true;
    return before;
}

void irq_unlock(unsigned int key)
{
    locked = key != 0U;
}

void k_fatal_halt(unsigned int reason)
{
    (void)printf("halted, reason %u, opening %g\n", reason, opening);
    exit(EXIT_SUCCESS);
}

double board_level(void)
{
    samples++;
    if (fails && (samples == 30)) {
        k_sys_fatal_error_handler(0U, NULL);
    }
    level += (opening - (0.3 * level)) * 0.01;
    return level;
}

void board_set_opening(double given)
{
    opening = given;
}

void board_set_lamp(bool on)
{
    (void)printf("lamp %s at tick %d\n", on ? "on" : "off", (int)uptime);
}

void board_enable_button(void)
{
    enabled = true;
}

int main(int count, char **arguments)
{
    fails = (count > 1) && (strcmp(arguments[1], "fault") == 0);
    tank_thread_entry(NULL, NULL, NULL);
    (void)printf("%d samples, level %.2f, opening %g, stack %zu\n", samples, level, opening, tank_thread_stack);
    return 0;
}
