/* One task on a scheduler whose ticks pass while it waits. The counter of ticks overflows soon after the start; an interrupt presses the button. */
#include <setjmp.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "board.h"
#include "task.h"
#include "tank_task.h"

enum { PRESSED = 500 /* ticks after the start */ };

static TaskFunction_t started;
static jmp_buf scheduler;
static TickType_t ticks = UINT32_MAX - 100U;
static int passed;
static uint32_t notified;
static double level = 0.2;
static double opening;
static int samples;
static bool fails;

TaskHandle_t xTaskCreateStatic(TaskFunction_t code, const char *name, uint32_t depth, void *parameters, UBaseType_t priority, StackType_t *stack,
                               StaticTask_t *control)
{
    (void)printf("task %s, %u words, priority %lu\n", name, (unsigned)depth, priority);
    assert((parameters == NULL) && (stack != NULL) && (control != NULL));
    started = code;
    return (TaskHandle_t)(void *)stack;
}

void vTaskDelete(TaskHandle_t task)
{
    assert(task == NULL);
    longjmp(scheduler, 1);
}

TickType_t xTaskGetTickCount(void)
{
    return ticks;
}

BaseType_t xTaskNotify(TaskHandle_t task, uint32_t value, eNotifyAction action)
{
    assert((task != NULL) && (action == eSetBits));
    notified |= value;
    return pdTRUE;
}

BaseType_t xTaskNotifyFromISR(TaskHandle_t task, uint32_t value, eNotifyAction action, BaseType_t *woken)
{
    *woken = pdTRUE;
    return xTaskNotify(task, value, action);
}

BaseType_t xTaskNotifyWait(uint32_t cleared_on_entry, uint32_t cleared_on_exit, uint32_t *value, TickType_t wait)
{
    TickType_t left = wait;
    notified &= ~cleared_on_entry;
    while ((notified == 0U) && (left > 0U)) {
        left--;
        ticks++;
        passed++;
        if (passed == PRESSED) {
            tank_task_button_from_isr();
        }
    }
    const BaseType_t came = (notified != 0U) ? pdTRUE : pdFALSE;
    *value = notified;
    notified &= ~cleared_on_exit;
    return came;
}

double board_level(void)
{
    samples++;
    if (fails && (samples == 30)) {
        tank_task_release(); /* what HardFault_Handler does */
        (void)printf("halted, opening %g\n", opening);
        exit(EXIT_SUCCESS);
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
    (void)printf("lamp %s at %d ms\n", on ? "on" : "off", passed);
}

void board_ended(const char *why)
{
    (void)printf("%s after %d samples, level %.2f, opening %g\n", why, samples, level, opening);
}

int main(int count, char **arguments)
{
    fails = (count > 1) && (strcmp(arguments[1], "fault") == 0);
    tank_task_start(3U);
    if (setjmp(scheduler) == 0) {
        started(NULL);
    }
    return 0;
}
