/* SPDX-License-Identifier: 0BSD */
/* The end of programs with actuators on POSIX systems: whatever ends the program, its outputs get their safe values first.
 *
 * Every signal that would end the process requests the run to stop, however many of them arrive. If it does not stop within CSP_GRACE seconds,
 * because a step or a device function hangs, the outputs are released from a signal handler in the thread of the run, and the program ends.
 * An output whose device function hangs then, too, is given up after the same time. A crash (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT,
 * SIGTRAP, SIGSYS), exit() and the end of the run's thread also release the outputs. If another thread crashes or exits, it waits until
 * the run has stopped. Signals that were ignored, such as SIGHUP under nohup and SIGINT for background jobs of scripts, and signals with
 * handlers of the program stay as they are. SIGURG is used to interrupt a run.
 */
#ifndef CSP_SIGNALS_H
#define CSP_SIGNALS_H

#include "csp_program.h"

#ifndef CSP_GRACE
#define CSP_GRACE 1U /* second; less than the time after which the starter of the program kills it */
#endif

#ifndef CSP_PATIENCE
#define CSP_PATIENCE 2U /* seconds */
#endif

/* Signals for errors that the processor or the library detects: they are never blocked. */
#define CSP_CRASHES SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS

/* To be called before and after a run, in its thread; calls may be nested. */
void csp_signals_begin(void);
void csp_signals_end(void);

/* From this call to csp_signals_end: if the run makes no progress for CSP_PATIENCE seconds, a step or a device function hangs. It is reported, the
 * outputs are released, and the program ends with status 1. */
void csp_signals_watch(int priority);

/* From this call to csp_signals_end: ten times a second a line is written to this descriptor, which must not block: the instant in nanoseconds, a
 * space, and, if the instant is that of the previous line, the process that is running: "Main (loops.csp:12)". */
void csp_signals_report(int descriptor);

/* From this call to csp_signals_end: a separate thread calls `attend` ten times a second. What ends the program before the run has ended by itself
 * calls it once more, for the last time. It must not wait for the run. */
void csp_signals_attend(void (*attend)(bool last));

/* The program ends as by SIGTERM when the other end of a pipe is closed, to which nothing is written: by the process that has started it, however that one
 * ends. SIGTERM ends it even if it was ignored, because that process uses it to end the program. */
void csp_signals_end_with(int pipe);

/* The exit status of the program: 0 if it ended by itself or at its time limit; 128 plus the number of the signal that stopped it, as in
 * shells; 1 otherwise. */
int csp_exit_status(csp_ending ending);

#endif
