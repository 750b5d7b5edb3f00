/* SPDX-License-Identifier: 0BSD */
/* Execution times on the target, by a counter of cycles: see the hooks `cycles` and `measured`. Simulations measure in csp_stream.c. */
#include "csp_internal.h"

#if CSP_MEASURE && !CSP_TRACE

static bool measures(const csp_kernel *csp)
{
    return (csp->hooks != NULL) && (csp->hooks->cycles != NULL) && (csp->hooks->measured != NULL);
}

static uint32_t cycles(const csp_kernel *csp)
{
    return csp->hooks->cycles(csp->hooks->context);
}

void csp_measure_begin(csp_kernel *csp)
{
    csp->measuring.depth = 0U;
    csp->measuring.began = measures(csp) ? cycles(csp) : 0U;
}

void csp_measure_party(csp_kernel *csp, uint32_t number)
{
    if (csp->measuring.depth < (uint32_t)CSP_DEEPEST) {
        csp->measuring.running[csp->measuring.depth] = number;
        csp->measuring.depth++;
    }
}

void csp_measure_end(csp_kernel *csp)
{
    if (measures(csp)) {
        const uint32_t took = cycles(csp) - csp->measuring.began;
        csp->measuring.steps += took;
        for (uint32_t index = 0U; index < csp->measuring.depth; index++) {
            csp->hooks->measured(csp->hooks->context, csp->measuring.running[index], took);
        }
    }
}

void csp_measure_enter(csp_kernel *csp)
{
    csp->measuring.entered = measures(csp) ? cycles(csp) : 0U;
}

void csp_measure_leave(csp_kernel *csp, bool done)
{
    if (measures(csp)) {
        csp->measuring.instant += cycles(csp) - csp->measuring.entered;
        if (done) {
            csp->hooks->measured(csp->hooks->context, 0U, csp->measuring.instant);
            csp->hooks->measured(csp->hooks->context, CSP_OUTSIDE, csp->measuring.instant - csp->measuring.steps);
            csp->measuring.instant = 0U;
            csp->measuring.steps = 0U;
        }
    }
}

#endif
