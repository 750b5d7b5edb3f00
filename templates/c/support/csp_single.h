/* SPDX-License-Identifier: 0BSD */
/* The functions of csp_arithmetic.h for reals in single precision: the same results, without an operation in double precision, for
 * processors whose floating-point unit has none.
 *
 * A quotient of two floats that is computed as a double and rounded is the quotient of floats, and comparisons are exact in either.
 */
#ifndef CSP_SINGLE_H
#define CSP_SINGLE_H

#include "csp_arithmetic.h"

static inline float csp_divide_single(csp_kernel *csp, float dividend, float divisor)
{
    return (divisor != 0.0f) ? dividend / divisor : (float)csp_real_division_fails(csp);
}

/* The value, with 0 for a negative zero: what adding 0 does. */
static inline float csp_positive_zero_single(float value)
{
    return value + 0.0f;
}

static inline float csp_min_single(float left, float right)
{
    return (right < left) ? right : left;
}

static inline float csp_max_single(float left, float right)
{
    return (right > left) ? right : left;
}

/* NaN stays NaN. */
static inline float csp_limit_single(float x, float low, float high)
{
    return (x < low) ? low : ((x > high) ? high : x);
}

/* -1, 0 or 1; NaN stays NaN. */
static inline float csp_sign_single(float x)
{
    return (x > 0.0f) ? 1.0f : ((x < 0.0f) ? -1.0f : x);
}

static inline float csp_deadzone_single(float x, float width)
{
    return (x > width) ? x - width : ((x < -width) ? x + width : (isnan(x) ? x : 0.0f));
}

static inline float csp_real_single(csp_kernel *csp, float value)
{
    return isfinite(value) ? value : (float)csp_real_fails(csp);
}

static inline bool csp_is_finite_single(float value)
{
    return isfinite(value) != 0;
}

static inline void csp_finite_single(csp_kernel *csp, float value, const char *port)
{
    if (!isfinite(value)) {
        csp_finite_fails(csp, (double)value, port);
    }
}

#endif
