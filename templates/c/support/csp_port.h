/* What the kernel needs of where it runs. Each port is one file csp_port_*.c. */
#ifndef CSP_PORT_H
#define CSP_PORT_H

#include <stdbool.h>
#include <stdint.h>

/* Called once at the start of time. */
void csp_port_start(void);

/* Called once at the end, after the safe values have been handed over. */
void csp_port_finish(void);

/* Nanoseconds since the start. */
int64_t csp_port_now(void);

/* Waits until the instant (INT64_MAX: there is none), or shorter, where something may have come from outside: an event that an interrupt
 * handler has brought, a request to stop. */
void csp_port_wait_until(int64_t instant);

/* The run meets this instant now: for measuring how late that is. */
void csp_port_met(int64_t instant);

/* Between them, what interrupt handlers do does not happen. */
void csp_port_enter_critical(void);
void csp_port_leave_critical(void);

/* Something that cannot go on: does not return. */
void csp_port_fatal(const char *message);

/* Of the bare machine only. Text for whoever debugs it; the end, which does not return; and what the interrupt of the clock calls. */
void csp_port_write(const char *text);
void csp_port_exit(bool successful);
void csp_port_tick(void);

/* Whether time is virtual: nothing takes time but waiting. */
extern const bool csp_port_virtual_time;

#endif
