/* SPDX-License-Identifier: 0BSD
 *
 * A superloop that owns the clock, and advances the tank of tank.csp when something is due. The board is simulated, so that the
 * example runs anywhere; on a real one its functions access registers.
 */
#include <stdio.h>

#include "tank_api.h"

#define MS INT64_C(1000000)

enum { STEPS = 64 }; /* of processes, before the rest of the loop has its turn */

/* ---- The board ---- */

static int64_t board_time; /* nanoseconds */
static double board_level = 0.2;
static double board_opening;

static int64_t board_now(void)
{
    return board_time;
}

static void board_sleep_until(int64_t instant)
{
    while (board_time < instant) { /* a board sleeps until its next interrupt */
        board_time += MS / 10;
        board_level += (board_opening - (0.3 * board_level)) * 1e-4;
    }
}

static uint32_t board_disable_interrupts(void)
{
    return 0U; /* whether they were enabled before */
}

static void board_restore_interrupts(uint32_t before)
{
    (void)before;
}

/* ---- What the program asks for ---- */

static bool sample(void *context, tank_input input, tank_inputs *inputs)
{
    (void)context;
    (void)input; /* there is only one */
    inputs->level = board_level;
    return true;
}

static void actuate(void *context, tank_output output, const tank_outputs *outputs, bool safe)
{
    (void)context;
    if (output == TANK_OUT_OPENING) {
        board_opening = outputs->opening;
    } else {
        (void)printf("lamp %s\n", outputs->lamp ? "on" : "off");
    }
    if (safe) {
        (void)printf("output %d is safe\n", (int)output);
    }
}

static uint32_t lock(void *context)
{
    (void)context;
    return board_disable_interrupts();
}

static void unlock(void *context, uint32_t before)
{
    (void)context;
    board_restore_interrupts(before);
}

/* ---- The loop ---- */

static tank_memory memory;
static tank_instance *tank;

static void on_button(void) /* an interrupt handler, enabled after tank_begin */
{
    (void)tank_button(tank, true);
}

int main(void)
{
    static const tank_hooks hooks = {
        .real_time = true, .sample = sample, .actuate = actuate, .lock = lock, .unlock = unlock};
    const char *reason = NULL;
    tank_state state = TANK_MORE;
    char text[120];
    tank = tank_begin(&memory, sizeof memory, &hooks, &reason);
    if (tank == NULL) {
        (void)printf("%s\n", reason);
        return 1;
    }
    while (tank_continues(state)) {
        state = tank_advance(tank, board_now(), STEPS);
        /* Here the rest of your loop has its turn. After 20 s somebody presses the button: */
        if ((state == TANK_MORE) && (board_now() >= 20000 * MS)) {
            (void)printf("level %.2f\n", board_level);
            on_button();
        }
        if (state == TANK_MORE) {
            board_sleep_until(tank_next(tank)); /* which is past after an event or a stop */
        }
    }
    tank_describe(tank, text, sizeof text);
    (void)printf("%s at %.2f s\n", text, (double)board_now() / 1e9);
    return (state == TANK_ENDED) ? 0 : 1;
}
