/* SPDX-License-Identifier: 0BSD */
/* The thread that watches a running program; an interface within the kernel. */
#ifndef CSP_WATCH_H
#define CSP_WATCH_H

#include <pthread.h>

#include "csp_signals.h"

enum { CSP_CHECKS = 10 /* checks per second */, CSP_SIGNALLED = 128 };

/* To be called before and after a run; `run` is its thread. */
void csp_watch_begin(pthread_t run);
void csp_watch_end(void);
/* To be called in a forked child, which has no such thread. */
void csp_watch_forget(void);
bool csp_watch_runs(void);
void csp_watch_lifeline(int descriptor);
void csp_watch_wait_for_check(void);
/* Writes a text to standard error if that is possible at once: outputs must not wait for a reader. Signal handlers may call it. */
void csp_watch_say(const char *text);
/* Calls the function of csp_signals_attend. */
void csp_watch_attend(bool last);

/* Defined in csp_signals.c: the signal that stopped the run, 0: none; and whether another thread ends the process when the outputs are released. */
uint32_t csp_signals_first(void);
bool csp_signals_leaving(void);
void csp_signals_ask_to_stop(int number);
void csp_signals_handle(int number, void (*handler)(int), int flags);
void csp_signals_wait_for_the_end(void);

#endif
