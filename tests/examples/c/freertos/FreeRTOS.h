/* What the example uses of FreeRTOS, as its headers declare it. */
#ifndef FREERTOS_H
#define FREERTOS_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

#define configTICK_RATE_HZ 1000U
#define configASSERT(condition) assert(condition)

typedef long BaseType_t;
typedef unsigned long UBaseType_t;
typedef uint32_t TickType_t;
typedef uint32_t StackType_t;
typedef struct StaticTask {
    int unused;
} StaticTask_t;

#define pdFALSE ((BaseType_t)0)
#define pdTRUE ((BaseType_t)1)
#define portMAX_DELAY ((TickType_t)0xffffffffUL)
#define portYIELD_FROM_ISR(switches) ((void)(switches))

#endif
