/* SPDX-License-Identifier: 0BSD */
/* The interface between the kernel and a platform. Each port of the kernel is one file, csp_port_*.c. */
#ifndef CSP_PORT_H
#define CSP_PORT_H

#include <stdbool.h>
#include <stdint.h>

#include "csp_config.h"

struct csp_kernel;

/* Called once at the start of time. */
void csp_port_start(void);

/* Called once at the end, after the safe values have been written. */
void csp_port_finish(struct csp_kernel *csp);

/* Called in each iteration of the run: after at most 64 steps of processes, and in idle times whenever csp_port_wait_until returns.
 * It is not called while a step or a device function hangs, so this is the place to kick a hardware watchdog. The definitions in the
 * ports of the kernel do nothing, and are replaced by one of your own. */
void csp_port_alive(void);

/* Nanoseconds since the start. */
int64_t csp_port_now(void);

/* Waits until the instant (INT64_MAX: none), or less. It returns immediately if csp_port_wake has been called since it last returned, and
 * stops waiting when csp_port_wake is called. */
void csp_port_wait_until(int64_t instant);

/* Called, also by interrupt handlers, when something has arrived from outside: an event, or a request to stop. */
void csp_port_wake(void);

/* Called when the run executes an instant, to measure how late that is. */
void csp_port_met(int64_t instant);

/* Interrupt handlers do not run between these two. They may be nested: the result of the first is passed to the second, which restores
 * the previous state. */
uint32_t csp_port_enter_critical(void);
void csp_port_leave_critical(uint32_t outside);

/* Called after an error from which the program cannot recover; does not return. */
void csp_port_fatal(const char *message);

/* On bare machines only: writes a text to the debugger; ends the program, and does not return; and what the timer interrupt calls. */
void csp_port_write(const char *text);
void csp_port_exit(bool successful);
void csp_port_tick(void);
/* Called after a fault of the processor, exit, abort or a failed assertion, in thread mode where the processor can, with interrupts of devices disabled: sets all
 * outputs to their safe values. The definition in the start-up code does so for csp_owned(); one of your own does it for instances of the step interface,
 * by NAME_release. If a device function faults meanwhile, it is called again. */
void csp_port_release(void);
/* The address of the instruction at which a fault of the processor came first; 0: there was none, or its stack had overflowed. */
uint32_t csp_port_faulted_at(void);
/* Stops the processor until an interrupt is pending, although interrupts are masked. The definition in the port of Cortex-M is one `wfi`, and is
 * replaced by one of your own, for a deeper sleep. */
void csp_port_sleep(void);

/* Whether time is virtual, so only waiting takes time. */
extern const bool csp_port_virtual_time;

#endif
