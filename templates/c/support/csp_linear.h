/* SPDX-License-Identifier: 0BSD */
/* Linear plants: states x with dx/dt = A x + r, where A is constant and r is held over a step.
 *
 * One step of the classical Runge-Kutta method over h seconds is then x = M x + N r, with M = I + h A S, N = h S and S = I + h A/2 (I + h A/3 (I + h A/4)).
 * M and N are kept for the lengths of the last steps: only instants that no period explains have new ones.
 */
#ifndef CSP_LINEAR_H
#define CSP_LINEAR_H

#include <stddef.h>

#include "csp_config.h"

enum { CSP_LINEAR_STATES = 8 /* at most */, CSP_LINEAR_KEPT = 4 };

typedef struct csp_rk4 {
    double h; /* in seconds; 0: none is kept here */
    double m[CSP_LINEAR_STATES][CSP_LINEAR_STATES];
    double n[CSP_LINEAR_STATES][CSP_LINEAR_STATES];
} csp_rk4;

typedef struct csp_linear {
    size_t states;
    double a[CSP_LINEAR_STATES][CSP_LINEAR_STATES];
    csp_rk4 kept[CSP_LINEAR_KEPT];
    size_t last;
} csp_linear;

/* Makes A zero, and forgets M and N, which also has to be done when A changes. */
void csp_linear_start(csp_linear *block, size_t states);

/* The same as csp_linear_step, for another h than that of the last step. */
const csp_rk4 *csp_linear_other_step(csp_linear *block, double h);

/* M and N for a step of h seconds, h > 0. */
static inline const csp_rk4 *csp_linear_step(csp_linear *block, double h)
{
    const csp_rk4 *const last = &block->kept[block->last];
    return (last->h == h) ? last : csp_linear_other_step(block, h);
}

#endif
