/* Signals of POSIX systems, for programs that drive something: whatever ends the program, its outputs get their safe values first.
 *
 * SIGINT, SIGTERM, SIGHUP, SIGQUIT and SIGPIPE ask the run to stop, however many of them come. If it does not within CSP_GRACE seconds,
 * because a step or a device function hangs, the outputs are released from a signal handler, and the program ends; an output whose device
 * function hangs then, too, is given up after the same time. A crash (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) and exit() release the
 * outputs as well. A SIGHUP that was ignored before, as nohup does, stays so.
 */
#ifndef CSP_SIGNALS_H
#define CSP_SIGNALS_H

#include "csp_program.h"

#ifndef CSP_GRACE
#define CSP_GRACE 1U /* second, less than who starts the program waits before it kills it */
#endif

#ifndef CSP_PATIENCE
#define CSP_PATIENCE 2U /* seconds */
#endif

/* From here to the end: if csp_signals_turn is not called for CSP_PATIENCE seconds, a step or a device function hangs. The outputs are
 * released, and the program ends with status 1. */
void csp_signals_watch(int priority);
void csp_signals_turn(void);

/* Around a run, in the thread that makes it; perhaps once more around that. */
void csp_signals_begin(void);
void csp_signals_end(void);

/* The program ends as by SIGTERM when the process of this number is no longer its parent. */
void csp_signals_end_with_parent(long parent);

/* The status to end the program with: 0 if it ended by itself or at its time limit; 128 and the number of the signal that stopped it, as
 * shells say it; 1 otherwise. */
int csp_exit_status(csp_ending ending);

#endif
