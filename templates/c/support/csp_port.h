/* What the kernel needs of where it runs. Each port is one file csp_port_*.c. */
#ifndef CSP_PORT_H
#define CSP_PORT_H

#include <stdbool.h>
#include <stdint.h>

struct csp_program;

/* Called once at the start of time. */
void csp_port_start(void);

/* Called once at the end, after the safe values have been handed over. */
void csp_port_finish(const struct csp_program *program);

/* Called in each turn of the run: after at most 64 steps of processes, and while nothing is to be done whenever csp_port_wait_until
 * comes back. A step or a device function that hangs keeps it from being called: the place to kick a hardware watchdog. The ports
 * that come with the kernel do nothing here, and one of your own takes its place. */
void csp_port_alive(void);

/* Nanoseconds since the start. */
int64_t csp_port_now(void);

/* Waits until the instant (INT64_MAX: there is none), or shorter. It does not wait, or not any longer, once csp_port_wake was called
 * since it came back last. */
void csp_port_wait_until(int64_t instant);

/* Something has come from outside: an event, a request to stop. Interrupt handlers call it. */
void csp_port_wake(void);

/* The run meets this instant now: for measuring how late that is. */
void csp_port_met(int64_t instant);

/* Between them, what interrupt handlers do does not happen. They may be nested: what the first returns is handed to the second, which
 * leaves everything as it was before. */
uint32_t csp_port_enter_critical(void);
void csp_port_leave_critical(uint32_t outside);

/* Something that cannot go on: does not return. */
void csp_port_fatal(const char *message);

/* Of the bare machine only. Text for whoever debugs it; the end, which does not return; and what the interrupt of the clock calls. */
void csp_port_write(const char *text);
void csp_port_exit(bool successful);
void csp_port_tick(void);

/* Whether time is virtual: nothing takes time but waiting. */
extern const bool csp_port_virtual_time;

#endif
