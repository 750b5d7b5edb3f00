/* What the example uses of the tasks of FreeRTOS. */
#ifndef TASK_H
#define TASK_H

#include "FreeRTOS.h"

typedef struct tskTaskControlBlock *TaskHandle_t;
typedef void (*TaskFunction_t)(void *);
typedef enum { eNoAction = 0, eSetBits } eNotifyAction;

TaskHandle_t xTaskCreateStatic(TaskFunction_t code, const char *name, uint32_t depth, void *parameters, UBaseType_t priority, StackType_t *stack,
                               StaticTask_t *control);
void vTaskDelete(TaskHandle_t task);
TickType_t xTaskGetTickCount(void);
BaseType_t xTaskNotify(TaskHandle_t task, uint32_t value, eNotifyAction action);
BaseType_t xTaskNotifyFromISR(TaskHandle_t task, uint32_t value, eNotifyAction action, BaseType_t *woken);
BaseType_t xTaskNotifyWait(uint32_t cleared_on_entry, uint32_t cleared_on_exit, uint32_t *value, TickType_t ticks);

#endif
