/* SPDX-License-Identifier: 0BSD */
/* Arithmetic as the language defines it: integers that never wrap silently, and IEEE 754 reals.
 *
 * Overflow, a value outside its type, an index outside its array, division by zero and a NaN for an actuator are *faults*, which a correct
 * program does not have. The function that finds a fault notes it in `csp_fault` and returns 0; evaluation continues without undefined
 * behaviour, and the first fault counts. Generated code checks for a fault after each statement that can have one.
 *
 * exp, log, sin, cos, tan, asin, acos, atan, atan2 and pow are those of libm, called through functions of this file, so compilers cannot replace them by
 * constants or formulas that differ in the last bit.
 */
#ifndef CSP_ARITHMETIC_H
#define CSP_ARITHMETIC_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "csp_core.h"

/* Durations: 2 * CSP_MS. */
#define CSP_S INT64_C(1000000000)
#define CSP_MS INT64_C(1000000)
#define CSP_US INT64_C(1000)

#define CSP_PI 3.141592653589793

/* ---- Faults ---- */

static inline bool csp_faulted(csp_kernel *csp)
{
    return csp->fault.describe != NULL;
}

/* Records where the fault happened; returns false, for use in `return csp_fault_at(...)`. */
CSP_COLD bool csp_fault_at(csp_kernel *csp, const char *place);

/* The same in a function that continues; its caller checks for a fault. */
static inline void csp_fault_in(csp_kernel *csp, const char *place)
{
    if (csp_faulted(csp)) {
        (void)csp_fault_at(csp, place);
    }
}

/* The same, and whether there was a fault. */
static inline bool csp_faulted_at(csp_kernel *csp, const char *place)
{
    const bool faulted = csp_faulted(csp);
    if (faulted) {
        (void)csp_fault_at(csp, place);
    }
    return faulted;
}

/* Raises the fault that was noted, in a part of the process with a name of its own: a control law, or a process that was flattened into it; NULL: none. */
CSP_COLD void csp_raise_noted_fault(csp_kernel *csp, csp_party *party, const char *part, const char *place);

/* Whether a fault was noted; then it is raised in this part of the process, which has to continue where it handles failures. */
static inline bool csp_raised_in(csp_kernel *csp, csp_party *party, const char *part, const char *place)
{
    const bool faulted = csp_faulted(csp);
    if (faulted) {
        csp_raise_noted_fault(csp, party, part, place);
    }
    return faulted;
}

/* The same outside of such parts. */
static inline bool csp_raised(csp_kernel *csp, csp_party *party, const char *place)
{
    return csp_raised_in(csp, party, NULL, place);
}

/* ---- Integers of 64 bits ---- */

/* Each notes the fault of an operation whose result does not fit, and returns 0. */
int64_t csp_add_fails(csp_kernel *csp, int64_t left, int64_t right);
int64_t csp_subtract_fails(csp_kernel *csp, int64_t left, int64_t right);
int64_t csp_multiply_fails(csp_kernel *csp, int64_t left, int64_t right);
int64_t csp_division_fails(csp_kernel *csp, int64_t left, int64_t right);

static inline bool csp_sum_fits(int64_t left, int64_t right)
{
    return (right >= 0) ? (left <= INT64_MAX - right) : (left >= INT64_MIN - right);
}

static inline bool csp_difference_fits(int64_t left, int64_t right)
{
    return (right >= 0) ? (left >= INT64_MIN + right) : (left <= INT64_MAX + right);
}

static inline bool csp_quotient_fits(int64_t dividend, int64_t divisor)
{
    return (divisor != 0) && ((divisor != -1) || (dividend != INT64_MIN));
}

static inline int64_t csp_add(csp_kernel *csp, int64_t left, int64_t right)
{
#if defined(__GNUC__)
    int64_t sum = 0;
    return __builtin_add_overflow(left, right, &sum) ? csp_add_fails(csp, left, right) : sum;
#else
    return csp_sum_fits(left, right) ? left + right : csp_add_fails(csp, left, right);
#endif
}

static inline int64_t csp_subtract(csp_kernel *csp, int64_t left, int64_t right)
{
#if defined(__GNUC__)
    int64_t difference = 0;
    return __builtin_sub_overflow(left, right, &difference) ? csp_subtract_fails(csp, left, right) : difference;
#else
    return csp_difference_fits(left, right) ? left - right : csp_subtract_fails(csp, left, right);
#endif
}

int64_t csp_multiply(csp_kernel *csp, int64_t left, int64_t right);

static inline int64_t csp_negate(csp_kernel *csp, int64_t operand)
{
    return (operand != INT64_MIN) ? -operand : csp_subtract_fails(csp, 0, operand);
}

static inline int64_t csp_absolute(csp_kernel *csp, int64_t operand)
{
    return (operand < 0) ? csp_negate(csp, operand) : operand;
}

/* Truncates toward zero. */
static inline int64_t csp_quotient(csp_kernel *csp, int64_t dividend, int64_t divisor)
{
    return csp_quotient_fits(dividend, divisor) ? dividend / divisor : csp_division_fails(csp, dividend, divisor);
}

/* Has the sign of the dividend. */
static inline int64_t csp_remainder(csp_kernel *csp, int64_t dividend, int64_t divisor)
{
    if ((divisor == 0) || (divisor == -1)) {
        return (divisor == 0) ? csp_division_fails(csp, dividend, divisor) : 0;
    }
    return dividend % divisor;
}

int64_t csp_power(csp_kernel *csp, int64_t base, int64_t exponent);

/* ---- The same for times, whose messages give them in seconds ---- */

int64_t csp_time_add_fails(csp_kernel *csp, int64_t left, int64_t right);
int64_t csp_time_subtract_fails(csp_kernel *csp, int64_t left, int64_t right);
int64_t csp_time_division_fails(csp_kernel *csp, int64_t left, int64_t right);

static inline int64_t csp_time_add(csp_kernel *csp, int64_t left, int64_t right)
{
    return csp_sum_fits(left, right) ? left + right : csp_time_add_fails(csp, left, right);
}

static inline int64_t csp_time_subtract(csp_kernel *csp, int64_t left, int64_t right)
{
    return csp_difference_fits(left, right) ? left - right : csp_time_subtract_fails(csp, left, right);
}

int64_t csp_time_multiply(csp_kernel *csp, int64_t left, int64_t right);

static inline int64_t csp_time_negate(csp_kernel *csp, int64_t operand)
{
    return (operand != INT64_MIN) ? -operand : csp_time_subtract_fails(csp, 0, operand);
}

static inline int64_t csp_time_absolute(csp_kernel *csp, int64_t operand)
{
    return (operand < 0) ? csp_time_negate(csp, operand) : operand;
}

static inline int64_t csp_time_quotient(csp_kernel *csp, int64_t dividend, int64_t divisor)
{
    return csp_quotient_fits(dividend, divisor) ? dividend / divisor : csp_time_division_fails(csp, dividend, divisor);
}

/* ---- Integers and times ---- */

/* Of any but the most negative number. */
static inline int64_t csp_absolute_int(int64_t operand)
{
    return (operand < 0) ? -operand : operand;
}

static inline int64_t csp_min_int(int64_t left, int64_t right)
{
    return (right < left) ? right : left;
}

static inline int64_t csp_max_int(int64_t left, int64_t right)
{
    return (right > left) ? right : left;
}

static inline int64_t csp_limit_int(int64_t x, int64_t low, int64_t high)
{
    return (x < low) ? low : ((x > high) ? high : x);
}

/* The duration from `now`, which is not negative, until an instant; 0 if the instant is past. */
static inline int64_t csp_until(int64_t instant, int64_t now)
{
    return (instant > now) ? instant - now : 0;
}

static inline int64_t csp_sign_int(int64_t x)
{
    return (x > 0) - (x < 0);
}

/* ---- Narrower integers ---- */

/* Notes that a value is outside a type. */
int64_t csp_outside(csp_kernel *csp, const char *type, int64_t value, int64_t low, int64_t high);

static inline int8_t csp_int8(csp_kernel *csp, int64_t value)
{
    const bool fits = (value >= (int64_t)INT8_MIN) && (value <= (int64_t)INT8_MAX);
    return (int8_t)(fits ? value : csp_outside(csp, "int8", value, (int64_t)INT8_MIN, (int64_t)INT8_MAX));
}

static inline int16_t csp_int16(csp_kernel *csp, int64_t value)
{
    const bool fits = (value >= (int64_t)INT16_MIN) && (value <= (int64_t)INT16_MAX);
    return (int16_t)(fits ? value : csp_outside(csp, "int16", value, (int64_t)INT16_MIN, (int64_t)INT16_MAX));
}

static inline int32_t csp_int32(csp_kernel *csp, int64_t value)
{
    const bool fits = (value >= (int64_t)INT32_MIN) && (value <= (int64_t)INT32_MAX);
    return (int32_t)(fits ? value : csp_outside(csp, "int32", value, (int64_t)INT32_MIN, (int64_t)INT32_MAX));
}

static inline uint8_t csp_uint8(csp_kernel *csp, int64_t value)
{
    const bool fits = (value >= 0) && (value <= (int64_t)UINT8_MAX);
    return (uint8_t)(fits ? value : csp_outside(csp, "uint8", value, 0, (int64_t)UINT8_MAX));
}

static inline uint16_t csp_uint16(csp_kernel *csp, int64_t value)
{
    const bool fits = (value >= 0) && (value <= (int64_t)UINT16_MAX);
    return (uint16_t)(fits ? value : csp_outside(csp, "uint16", value, 0, (int64_t)UINT16_MAX));
}

static inline uint32_t csp_uint32(csp_kernel *csp, int64_t value)
{
    const bool fits = (value >= 0) && (value <= (int64_t)UINT32_MAX);
    return (uint32_t)(fits ? value : csp_outside(csp, "uint32", value, 0, (int64_t)UINT32_MAX));
}

/* Reals are truncated toward zero. */
int64_t csp_int64_of_real(csp_kernel *csp, double value);
int64_t csp_whole_of_real(csp_kernel *csp, const char *type, double value, int64_t low, int64_t high);

static inline int8_t csp_int8_of_real(csp_kernel *csp, double value)
{
    return (int8_t)csp_whole_of_real(csp, "int8", value, INT8_MIN, INT8_MAX);
}

static inline int16_t csp_int16_of_real(csp_kernel *csp, double value)
{
    return (int16_t)csp_whole_of_real(csp, "int16", value, INT16_MIN, INT16_MAX);
}

static inline int32_t csp_int32_of_real(csp_kernel *csp, double value)
{
    return (int32_t)csp_whole_of_real(csp, "int32", value, INT32_MIN, INT32_MAX);
}

static inline uint8_t csp_uint8_of_real(csp_kernel *csp, double value)
{
    return (uint8_t)csp_whole_of_real(csp, "uint8", value, 0, UINT8_MAX);
}

static inline uint16_t csp_uint16_of_real(csp_kernel *csp, double value)
{
    return (uint16_t)csp_whole_of_real(csp, "uint16", value, 0, UINT16_MAX);
}

static inline uint32_t csp_uint32_of_real(csp_kernel *csp, double value)
{
    return (uint32_t)csp_whole_of_real(csp, "uint32", value, 0, UINT32_MAX);
}

/* ---- Elements ---- */

int64_t csp_index_fails(csp_kernel *csp, int64_t index, int64_t size);

/* `index` if it is an index of an array of that size; otherwise notes a fault. */
static inline size_t csp_index(csp_kernel *csp, int64_t index, int64_t size)
{
    return (size_t)(((index >= 0) && (index < size)) ? index : csp_index_fails(csp, index, size));
}

/* ---- Reals ---- */

double csp_real_division_fails(csp_kernel *csp);

static inline double csp_divide(csp_kernel *csp, double dividend, double divisor)
{
    return (divisor != 0.0) ? dividend / divisor : csp_real_division_fails(csp);
}

/* The value, with 0 for a negative zero: what adding 0 does. */
static inline double csp_positive_zero(double value)
{
    return value + 0.0;
}

static inline double csp_min(double left, double right)
{
    return (right < left) ? right : left;
}

static inline double csp_max(double left, double right)
{
    return (right > left) ? right : left;
}

/* NaN stays NaN. */
static inline double csp_limit(double x, double low, double high)
{
    return (x < low) ? low : ((x > high) ? high : x);
}

/* -1, 0 or 1; NaN stays NaN. */
static inline double csp_sign(double x)
{
    return (x > 0.0) ? 1.0 : ((x < 0.0) ? -1.0 : x);
}

/* The nearest multiple of `step`, with halves rounded away from zero; NaN for step 0. */
static inline double csp_quantize(double x, double step)
{
    return round(x / step) * step;
}

static inline double csp_deadzone(double x, double width)
{
    return (x > width) ? x - width : ((x < -width) ? x + width : (isnan(x) ? x : 0.0));
}

double csp_exp(double x);
double csp_log(double x);
double csp_sin(double x);
double csp_cos(double x);
double csp_tan(double x);
double csp_asin(double x);
double csp_acos(double x);
double csp_atan(double x);
double csp_atan2(double y, double x);
double csp_pow(double base, double exponent);

/* A duration in seconds, rounded once. */
double csp_seconds(int64_t nanoseconds);

double csp_real_fails(csp_kernel *csp);

/* Whether a value is neither infinite nor a NaN. By its exponent: where `double` is computed in software, comparisons are calls of the compiler's library.
 * A sum is finite only if its terms are: one test is enough for several values, unless it fails. */
static inline bool csp_is_finite(double value)
{
    uint64_t bits = 0U;
    (void)memcpy(&bits, &value, sizeof bits);
    return (~(uint32_t)(bits >> 32U) & UINT32_C(0x7FF00000)) != 0U;
}

/* Every real value of a program is finite: notes a fault for an infinity or a NaN. */
static inline double csp_real(csp_kernel *csp, double value)
{
    return csp_is_finite(value) ? value : csp_real_fails(csp);
}

/* Notes a fault with its place for an infinity or a NaN. */
void csp_finite_at(csp_kernel *csp, double value, const char *place);

/* `port` is the name of the output of the program, or NULL: an output of a law. */
void csp_finite_fails(csp_kernel *csp, double value, const char *port);

/* `type` is the name of an enumeration. */
void csp_enumerator_fails(csp_kernel *csp, int64_t value, const char *type);

/* Notes a fault unless a number is that of one of the values of an enumeration, of which there are `count`. */
static inline void csp_enumerator(csp_kernel *csp, int64_t value, int64_t count, const char *type)
{
    if ((value < 0) || (value >= count)) {
        csp_enumerator_fails(csp, value, type);
    }
}

/* Notes the fault that a variable was read before it was written. */
void csp_not_written(csp_kernel *csp, const char *variable);

/* Notes the fault that a device could not be opened, after which nothing is handed over. Always false. */
bool csp_device_refused(csp_kernel *csp, const char *device, const char *place);

/* Notes a fault unless a value that is written to a port is finite. */
static inline void csp_finite(csp_kernel *csp, double value, const char *port)
{
    if (!csp_is_finite(value)) {
        csp_finite_fails(csp, value, port);
    }
}

#include "csp_single.h"

#endif
