/* SPDX-License-Identifier: 0BSD */
/* See csp_linear.h. The order of operations is that of the language reference, so results are the same to the bit everywhere. */
#include "csp_linear.h"

#include <string.h>

void csp_linear_start(csp_linear *block, size_t states)
{
    memset(block, 0, sizeof *block);
    block->states = states;
}

/* A column of h A S, for that of S. */
static void multiply(const csp_linear *block, double h, const double *column, double *product)
{
    for (size_t i = 0; i < block->states; i++) {
        product[i] = 0.0;
        for (size_t k = 0; k < block->states; k++) {
            product[i] += (h * block->a[i][k]) * column[k];
        }
    }
}

static void compute(const csp_linear *block, double h, csp_rk4 *step)
{
    step->h = h;
    for (size_t j = 0; j < block->states; j++) {
        double column[CSP_LINEAR_STATES] = {0};
        double product[CSP_LINEAR_STATES] = {0};
        column[j] = 1.0;
        for (int divisor = 4; divisor >= 2; divisor--) {
            multiply(block, h, column, product);
            for (size_t i = 0; i < block->states; i++) {
                const double quotient = product[i] / (double)divisor;
                column[i] = (i == j) ? 1.0 + quotient : quotient;
            }
        }
        multiply(block, h, column, product);
        for (size_t i = 0; i < block->states; i++) {
            step->m[i][j] = (i == j) ? 1.0 + product[i] : product[i];
            step->n[i][j] = h * column[i];
        }
    }
}

const csp_rk4 *csp_linear_other_step(csp_linear *block, double h)
{
    for (size_t k = 0; k < CSP_LINEAR_KEPT; k++) {
        if (block->kept[k].h == h) {
            block->last = k;
            return &block->kept[k];
        }
    }
    block->last = (block->last + 1U) % CSP_LINEAR_KEPT;
    compute(block, h, &block->kept[block->last]);
    return &block->kept[block->last];
}
