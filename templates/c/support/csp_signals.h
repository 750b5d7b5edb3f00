/* Ends of a program on POSIX systems, for programs that drive something: whatever ends it, its outputs get their safe values first.
 *
 * Every signal that would end the process asks the run to stop, however many of them come. If it does not within CSP_GRACE seconds,
 * because a step or a device function hangs, the outputs are released from a signal handler in the thread of the run, and the program ends;
 * an output whose device function hangs then, too, is given up after the same time. A crash (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT,
 * SIGTRAP, SIGSYS), exit() and the end of the run's thread release the outputs as well. If it is another thread that crashes or exits, it
 * waits until the run has stopped. Signals that were ignored, as SIGHUP under nohup and SIGINT in the background of a script, and those that
 * have handlers of the program's own, stay as they are. SIGURG is used while a run has to be interrupted.
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

/* Those of what the processor or the library finds wrong: they are never held back. */
#define CSP_CRASHES SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS

/* Around a run, in the thread that makes it; perhaps once more around that. */
void csp_signals_begin(void);
void csp_signals_end(void);

/* From here to the end: if the run makes no turn for CSP_PATIENCE seconds, a step or a device function hangs. It is named, the outputs are
 * released, and the program ends with status 1. */
void csp_signals_watch(int priority);

/* From here to the end: ten times a second a line goes to this descriptor, which is not to block: the instant in nanoseconds, a space, and, where
 * that is the one of the line before, who is at work: "Main (loops.csp:12)". */
void csp_signals_tell(int descriptor);

/* From here to the end: a thread of its own calls it ten times a second, and whoever ends the program before its run has ended by itself calls it
 * once more, for the last time. It is not to wait for the run. */
void csp_signals_attend(void (*attend)(bool last));

/* The program ends as by SIGTERM when the process of this number is no longer its parent, which asks it to end by SIGTERM, even if that was
 * ignored. */
void csp_signals_end_with_parent(long parent);

/* The status to end the program with: 0 if it ended by itself or at its time limit; 128 and the number of the signal that stopped it, as
 * shells say it; 1 otherwise. */
int csp_exit_status(csp_ending ending);

#endif
