/* SPDX-License-Identifier: 0BSD */
#ifndef TANK_TASK_H
#define TANK_TASK_H

#include "FreeRTOS.h"

/* Creates the task; before vTaskStartScheduler or later. */
void tank_task_start(UBaseType_t priority);

/* Ends the run, with safe outputs; from any task. */
void tank_task_stop(void);

/* Hands over safe values now; for HardFault_Handler, vApplicationStackOverflowHook and what configASSERT calls. */
void tank_task_release(void);

/* The button has been pressed; from its interrupt handler, whose priority must allow calls of FreeRTOS. */
void tank_task_button_from_isr(void);

#endif
