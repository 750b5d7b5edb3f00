/* The measures of one run: signals have the values that were observed last, and each measure takes its own when an instant is over. */
#ifndef CSP_SWEEP_MEASURES_H
#define CSP_SWEEP_MEASURES_H

#include "csp_sweep.h"

/* Makes measures of these signals, for all runs. False: there is no memory. */
bool csp_sweep_make_measures(const csp_sweep_signal *of, uint32_t observed, const csp_sweep_measure *wanted, uint32_t count);
/* To be called before each run. */
void csp_sweep_begin_measures(void);
/* A port shows a value. */
void csp_sweep_observe_port(int64_t now, uint32_t port, const void *value);
/* The environment has advanced to an instant. */
void csp_sweep_observe_states(const csp_sweep *sweep, int64_t now);
/* To be called after each run, once: its last instant is over. */
void csp_sweep_end_measures(void);
/* What was measured of a run that ended at this instant; NAN: nothing. */
double csp_sweep_measured(uint32_t index, int64_t end);

#endif
