/* SPDX-License-Identifier: 0BSD
 *
 * The tank of ../superloop/tank.csp without an operating system: the processor sleeps until the next instant, or
 * until the interrupt of the button.
 */
#include <stddef.h>

#include "board.h"
#include "tank_api.h"

#define MS INT64_C(1000000)

enum { STEPS = 64 /* of processes, before the rest of the loop has its turn */ };

/* ---- The plant, where a machine has its drivers ---- */

static double level = 0.2;
static double opening;

static bool sample(void *context, tank_input input, tank_inputs *inputs)
{
    (void)context;
    (void)input; /* there is only one */
    level += (opening - (0.3 * level)) * 0.01;
    inputs->level = level;
    return true;
}

static void actuate(void *context, tank_output output, const tank_outputs *outputs, bool safe)
{
    (void)context;
    if (output == TANK_OUT_OPENING) {
        opening = outputs->opening;
    } else {
        board_write(outputs->lamp ? "lamp on\n" : "lamp off\n");
    }
    if (safe) {
        board_write("an output is safe\n");
    }
}

/* ---- Events come from interrupt handlers ---- */

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

static void wake(void *context)
{
    (void)context;
    board_wake();
}

/* ---- The loop ---- */

static tank_memory memory;
static tank_instance *tank;

void on_button(void)
{
    (void)tank_button(tank, true);
}

void on_fault(void)
{
    char text[120];
    if (tank == NULL) {
        return; /* before tank_begin there is nothing to release */
    }
    tank_release(tank);
    tank_describe(tank, text, sizeof text); /* "running: Tank (last waited at tank.csp:14)" */
    board_write(text);
    board_write("\n");
}

int main(void)
{
    static const tank_hooks hooks = {
        .real_time = true, .sample = sample, .actuate = actuate, .lock = lock, .unlock = unlock, .wake = wake};
    const char *reason = NULL;
    tank_state state = TANK_MORE;
    bool pressed = false;
    char text[120];
    board_start();
    tank = tank_begin(&memory, sizeof memory, &hooks, &reason);
    if (tank == NULL) {
        board_write(reason);
        return 1;
    }
    board_enable_button(); /* not before: its handler needs the program */
    while (tank_continues(state)) {
        state = tank_advance(tank, board_now(), STEPS);
        /* Here the rest of your loop has its turn. After half a second somebody presses the button: */
        if (!pressed && (board_now() >= 500 * MS)) {
            pressed = true;
            board_write((level > 0.5) ? "filling\n" : "not filling\n");
            board_press_button();
        }
        if (state == TANK_MORE) {
            board_sleep_until(tank_next(tank)); /* which is past after an event or a stop */
        }
    }
    tank_describe(tank, text, sizeof text);
    board_write(text);
    board_write("\n");
    return (state == TANK_ENDED) ? 0 : 1;
}
