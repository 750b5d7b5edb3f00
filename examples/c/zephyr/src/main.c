/* SPDX-License-Identifier: 0BSD
 *
 * The tank of ../superloop/tank.csp as a thread of Zephyr. It sleeps until the next instant, or until an event
 * comes from an interrupt handler or another thread.
 */
#include <zephyr/fatal.h>
#include <zephyr/irq.h>
#include <zephyr/kernel.h>

#include "board.h"
#include "tank_api.h"

#define STACK 2048 /* bytes */
#define STEPS 64U  /* of processes between two looks at the clock */

K_SEM_DEFINE(wakes, 0, 1);

/* ---- What the program asks for ---- */

static bool sample(void *context, tank_input input, tank_inputs *inputs)
{
    ARG_UNUSED(context);
    ARG_UNUSED(input); /* there is only one */
    inputs->level = board_level();
    return true;
}

static void actuate(void *context, tank_output output, const tank_outputs *outputs, bool safe)
{
    ARG_UNUSED(context);
    ARG_UNUSED(safe); /* a safe value is handed over like any other */
    if (output == TANK_OUT_OPENING) {
        board_set_opening(outputs->opening);
    } else {
        board_set_lamp(outputs->lamp);
    }
}

static uint32_t lock(void *context)
{
    ARG_UNUSED(context);
    return irq_lock(); /* may be nested, and used in interrupt handlers */
}

static void unlock(void *context, uint32_t before)
{
    ARG_UNUSED(context);
    irq_unlock(before);
}

static void wake(void *context)
{
    ARG_UNUSED(context);
    k_sem_give(&wakes);
}

/* ---- The thread ---- */

static tank_memory memory;
static tank_instance *tank;

/* Sleeps until an instant after `started`, which is in ticks. */
static void sleep_until(int64_t started, int64_t instant)
{
    if (instant == INT64_MAX) {
        (void)k_sem_take(&wakes, K_FOREVER);
    } else {
        (void)k_sem_take(&wakes, K_TIMEOUT_ABS_TICKS(started + (int64_t)k_ns_to_ticks_ceil64((uint64_t)instant)));
    }
}

static void run(void *one, void *two, void *three)
{
    static const tank_hooks hooks = {
        .real_time = true, .sample = sample, .actuate = actuate, .lock = lock, .unlock = unlock, .wake = wake};
    const int64_t started = k_uptime_ticks();
    tank_state state = TANK_MORE;
    const char *reason = NULL;
    char text[120];
    ARG_UNUSED(one);
    ARG_UNUSED(two);
    ARG_UNUSED(three);
    tank = tank_begin(&memory, sizeof memory, &hooks, &reason);
    if (tank == NULL) {
        printk("%s\n", reason);
        return;
    }
    board_enable_button(); /* from now on tank_button may be called */
    while (tank_continues(state)) {
        state = tank_advance(tank, (int64_t)k_ticks_to_ns_floor64((uint64_t)(k_uptime_ticks() - started)), STEPS);
        if (state == TANK_MORE) {
            sleep_until(started, tank_next(tank));
        }
    }
    tank_describe(tank, text, sizeof text);
    printk("%s\n", text);
}

K_THREAD_DEFINE(tank_thread, STACK, run, NULL, NULL, NULL, K_PRIO_COOP(1), 0, 0);

/* Instead of Zephyr's: after a fault of the processor, safe values come before everything halts. */
void k_sys_fatal_error_handler(unsigned int reason, const struct arch_esf *esf)
{
    ARG_UNUSED(esf);
    if (tank != NULL) {
        tank_release(tank);
    }
    k_fatal_halt(reason);
}

/* Called by the interrupt handler of the button. */
void on_button(void)
{
    (void)tank_button(tank, true);
}
