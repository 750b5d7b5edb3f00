/* SPDX-License-Identifier: 0BSD
 *
 * The tank of ../superloop/tank.csp as a task of FreeRTOS. It sleeps until the next instant, or until an interrupt
 * notifies it. All calls of tank_... are made by the task.
 */
#include "FreeRTOS.h"
#include "task.h"

#include "board.h"
#include "tank_api.h"
#include "tank_task.h"

enum { STEPS = 64 /* of processes between two looks at the clock */, STACK = 512 /* words */ };

enum { BUTTON = 1, STOP = 2 }; /* bits of a notification */

#define NANOSECONDS_IN_TICK (INT64_C(1000000000) / configTICK_RATE_HZ)

static TaskHandle_t task;
static tank_instance *tank;

/* ---- What the program asks for ---- */

static bool sample(void *context, tank_input input, tank_inputs *inputs)
{
    (void)context;
    (void)input; /* there is only one */
    inputs->level = board_level();
    return true;
}

static void actuate(void *context, tank_output output, const tank_outputs *outputs, bool safe)
{
    (void)context;
    (void)safe; /* a safe value is handed over like any other */
    if (output == TANK_OUT_OPENING) {
        board_set_opening(outputs->opening);
    } else {
        board_set_lamp(outputs->lamp);
    }
}

/* Interrupt handlers do not call tank_button: they notify the task, which does. So there is nothing to lock. */
static uint32_t lock(void *context)
{
    (void)context;
    return 0U;
}

static void unlock(void *context, uint32_t before)
{
    (void)context;
    (void)before;
}

/* ---- Time ---- */

/* Nanoseconds since the first call; TickType_t overflows. */
static int64_t now(void)
{
    static TickType_t last;
    static int64_t present = -1;
    const TickType_t ticks = xTaskGetTickCount();
    present = (present < 0) ? 0 : (present + ((int64_t)(TickType_t)(ticks - last) * NANOSECONDS_IN_TICK));
    last = ticks;
    return present;
}

/* The ticks until an instant, rounded up: at the tick it has come. An instant that is past gives none. */
static TickType_t ticks_until(int64_t instant, int64_t present)
{
    const int64_t rest = instant - present;
    if (rest <= 0) {
        return 0U;
    }
    const int64_t ticks = (rest - 1) / NANOSECONDS_IN_TICK + 1;
    return (ticks < (int64_t)(portMAX_DELAY / 2U)) ? (TickType_t)ticks : (portMAX_DELAY / 2U);
}

/* ---- The task ---- */

static void run(void *unused)
{
    static tank_memory memory;
    static const tank_hooks hooks = {
        .real_time = true, .sample = sample, .actuate = actuate, .lock = lock, .unlock = unlock};
    const char *reason = NULL;
    tank_state state = TANK_MORE;
    (void)unused;
    tank = tank_begin(&memory, sizeof memory, &hooks, &reason);
    if (tank == NULL) {
        board_ended(reason);
        vTaskDelete(NULL);
    }
    while (tank_continues(state)) {
        const int64_t present = now();
        uint32_t bits = 0U;
        state = tank_advance(tank, present, STEPS);
        (void)xTaskNotifyWait(0U, UINT32_MAX, &bits, (state == TANK_MORE) ? ticks_until(tank_next(tank), present) : 0U);
        if ((bits & BUTTON) != 0U) {
            (void)tank_button(tank, true);
        }
        if ((bits & STOP) != 0U) {
            tank_stop(tank);
        }
    }
    char text[120];
    tank_describe(tank, text, sizeof text);
    board_ended(text);
    vTaskDelete(NULL);
}

void tank_task_start(UBaseType_t priority)
{
    static StaticTask_t control;
    static StackType_t stack[STACK];
    task = xTaskCreateStatic(run, "tank", STACK, NULL, priority, stack, &control);
}

void tank_task_stop(void)
{
    (void)xTaskNotify(task, STOP, eSetBits);
}

void tank_task_release(void)
{
    if (tank != NULL) {
        tank_release(tank);
    }
}

void tank_task_button_from_isr(void)
{
    BaseType_t woken = pdFALSE;
    (void)xTaskNotifyFromISR(task, BUTTON, eSetBits, &woken);
    portYIELD_FROM_ISR(woken);
}
