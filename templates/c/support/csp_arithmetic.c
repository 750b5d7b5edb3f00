/* SPDX-License-Identifier: 0BSD */
/* See csp_arithmetic.h. */
#include "csp_arithmetic.h"

#include "csp_fault_text.h"
#include "csp_program.h"

#if !CSP_USES_TEXTS
static void describe_nothing(const csp_operands *operands, char *text, size_t size)
{
    (void)operands;
    if (size > 0U) {
        text[0] = '\0';
    }
}
#endif

/* Notes a fault; the first one counts. */
static void note(csp_kernel *csp, void (*describe)(const csp_operands *, char *, size_t), csp_operands operands)
{
    if (csp->fault.describe == NULL) {
        csp->fault.place = NULL;
        csp->fault.law = NULL;
#if CSP_USES_TEXTS
        csp->fault.describe = describe;
        csp->fault.operands = operands;
#else
        (void)describe;
        (void)operands;
        csp->fault.describe = describe_nothing;
#endif
    }
}

static csp_operands pair(int64_t left, int64_t right)
{
    return (csp_operands){{left, right, 0}, 0.0, NULL};
}

static csp_operands times(int64_t left, int64_t right)
{
    return (csp_operands){{left, right, 0}, 0.0, "time"};
}

bool csp_fault_at(csp_kernel *csp, const char *place)
{
    if (csp->fault.place == NULL) {
        csp->fault.place = place;
    }
    return false;
}

int64_t csp_add_fails(csp_kernel *csp, int64_t left, int64_t right)
{
    note(csp, csp_describe_sum, pair(left, right));
    return 0;
}

int64_t csp_subtract_fails(csp_kernel *csp, int64_t left, int64_t right)
{
    note(csp, csp_describe_difference, pair(left, right));
    return 0;
}

int64_t csp_multiply_fails(csp_kernel *csp, int64_t left, int64_t right)
{
    note(csp, csp_describe_product, pair(left, right));
    return 0;
}

int64_t csp_division_fails(csp_kernel *csp, int64_t left, int64_t right)
{
    if (right == 0) {
        note(csp, csp_describe_division, pair(left, right));
    } else {
        note(csp, csp_describe_difference, pair(0, left)); /* the lowest number divided by -1 */
    }
    return 0;
}

static inline bool product_fits(int64_t left, int64_t right)
{
    const bool small = (left >= INT32_MIN) && (left <= INT32_MAX) && (right >= INT32_MIN) && (right <= INT32_MAX);
    if (small || (left == 0) || (right == 0)) {
        return true;
    }
    if (left > 0) {
        return (right > 0) ? (left <= INT64_MAX / right) : (right >= INT64_MIN / left);
    }
    return (right > 0) ? (left >= INT64_MIN / right) : (right >= INT64_MAX / left);
}

int64_t csp_multiply(csp_kernel *csp, int64_t left, int64_t right)
{
    return product_fits(left, right) ? left * right : csp_multiply_fails(csp, left, right);
}

int64_t csp_time_add_fails(csp_kernel *csp, int64_t left, int64_t right)
{
    note(csp, csp_describe_sum, times(left, right));
    return 0;
}

int64_t csp_time_subtract_fails(csp_kernel *csp, int64_t left, int64_t right)
{
    note(csp, csp_describe_difference, times(left, right));
    return 0;
}

int64_t csp_time_division_fails(csp_kernel *csp, int64_t left, int64_t right)
{
    return (right == 0) ? csp_division_fails(csp, left, right) : csp_time_subtract_fails(csp, 0, left);
}

int64_t csp_time_multiply(csp_kernel *csp, int64_t left, int64_t right)
{
    if (!product_fits(left, right)) {
        note(csp, csp_describe_product, times(left, right));
        return 0;
    }
    return left * right;
}

int64_t csp_power(csp_kernel *csp, int64_t base, int64_t exponent)
{
    if (exponent < 0) {
        note(csp, csp_describe_negative_exponent, pair(base, exponent));
        return 0;
    }
    if ((base >= -1) && (base <= 1)) {
        return (exponent == 0) ? 1 : (((exponent % 2) == 0) ? base * base : base);
    }
    if (exponent > 63) {
        note(csp, csp_describe_power, pair(base, exponent));
        return 0;
    }
    /* The magnitude of the result is at most 2^63, and the lowest number has that magnitude. */
    const uint64_t magnitude = (base < 0) ? (uint64_t)0 - (uint64_t)base : (uint64_t)base;
    const bool negative = (base < 0) && ((exponent % 2) == 1);
    const uint64_t greatest = negative ? (uint64_t)INT64_MAX + 1U : (uint64_t)INT64_MAX;
    uint64_t result = 1;
    for (int64_t count = 0; count < exponent; count++) {
        if (result > greatest / magnitude) {
            note(csp, csp_describe_power_value, pair(base, exponent));
            return 0;
        }
        result *= magnitude;
    }
    if (negative) {
        return (result > (uint64_t)INT64_MAX) ? INT64_MIN : -(int64_t)result;
    }
    return (int64_t)result;
}

int64_t csp_outside(csp_kernel *csp, const char *type, int64_t value, int64_t low, int64_t high)
{
    note(csp, csp_describe_outside, (csp_operands){{value, low, high}, 0.0, type});
    return 0;
}

int64_t csp_whole_of_real(csp_kernel *csp, const char *type, double value, int64_t low, int64_t high)
{
    if ((value > (double)low - 1.0) && (value < (double)high + 1.0)) {
        return (int64_t)value;
    }
    note(csp, csp_describe_real_outside, (csp_operands){{0, low, high}, value, type});
    return 0;
}

int64_t csp_int64_of_real(csp_kernel *csp, double value)
{
    if ((value >= -9223372036854775808.0) && (value < 9223372036854775808.0)) {
        return (int64_t)value;
    }
    note(csp, csp_describe_real_outside, (csp_operands){{0, INT64_MIN, INT64_MAX}, value, "int"});
    return 0;
}

int64_t csp_index_fails(csp_kernel *csp, int64_t index, int64_t size)
{
    note(csp, csp_describe_index, pair(index, size));
    return 0;
}

double csp_real_division_fails(csp_kernel *csp)
{
    note(csp, csp_describe_real_division, pair(0, 0));
    return 0.0;
}

double csp_real_fails(csp_kernel *csp)
{
    note(csp, csp_describe_not_a_number, pair(0, 0));
    return 0.0;
}

void csp_finite_at(csp_kernel *csp, double value, const char *place)
{
    if (!csp_is_finite(value)) {
        (void)csp_real_fails(csp);
        (void)csp_fault_at(csp, place);
    }
}

void csp_finite_fails(csp_kernel *csp, double value, const char *port)
{
    note(csp, (port != NULL) ? csp_describe_not_finite : csp_describe_not_a_number, (csp_operands){{0, 0, 0}, value, port});
}

void csp_enumerator_fails(csp_kernel *csp, int64_t value, const char *type)
{
    note(csp, csp_describe_enumerator, (csp_operands){{value, 0, 0}, 0.0, type});
}

void csp_not_written(csp_kernel *csp, const char *variable)
{
    note(csp, csp_describe_not_written, (csp_operands){{0, 0, 0}, 0.0, variable});
}

bool csp_device_refused(csp_kernel *csp, const char *device, const char *place)
{
    csp_forget_outputs(csp);
    note(csp, csp_describe_not_opened, (csp_operands){{0, 0, 0}, 0.0, device});
    return csp_fault_at(csp, place);
}

double csp_exp(double x)
{
    return exp(x);
}

double csp_log(double x)
{
    return log(x);
}

double csp_sin(double x)
{
    return sin(x);
}

double csp_cos(double x)
{
    return cos(x);
}

double csp_tan(double x)
{
    return tan(x);
}

double csp_asin(double x)
{
    return asin(x);
}

double csp_acos(double x)
{
    return acos(x);
}

double csp_atan(double x)
{
    return atan(x);
}

double csp_atan2(double y, double x)
{
    return atan2(y, x);
}

double csp_pow(double base, double exponent)
{
    return pow(base, exponent);
}

/* A step of a long division by 10^9 in binary: brings down the next digit of the dividend, and appends one to the quotient. */
static void divide_next(uint32_t digit, uint64_t *quotient, uint32_t *rest)
{
    const uint32_t dividend = (*rest * 2U) + digit;
    const bool goes = dividend >= UINT32_C(1000000000);
    *rest = goes ? (dividend - UINT32_C(1000000000)) : dividend;
    *quotient = (*quotient * 2U) + (goes ? 1U : 0U);
}

/* The same of more than 2^53 nanoseconds: 53 digits, and then whether to round up. By steps, because a division of 64 bits takes as much flash as this on
 * processors that have none. */
static double many_seconds(int64_t nanoseconds)
{
    const bool negative = nanoseconds < 0;
    uint64_t magnitude = negative ? (uint64_t)0 - (uint64_t)nanoseconds : (uint64_t)nanoseconds;
    uint64_t digits = 0U;
    uint32_t rest = 0U;
    double unit = 1.0;
    for (uint32_t bit = 0U; bit < 64U; bit++) {
        divide_next((uint32_t)(magnitude >> 63U), &digits, &rest);
        magnitude *= 2U;
    }
    while (digits < (UINT64_C(1) << 52)) {
        divide_next(0U, &digits, &rest);
        unit /= 2.0;
    }
    rest *= 2U;
    if ((rest > UINT32_C(1000000000)) || ((rest == UINT32_C(1000000000)) && ((digits % 2U) == 1U))) {
        digits++;
    }
    const double seconds = (double)(int64_t)digits * unit;
    return negative ? -seconds : seconds;
}

/* Up to 2^53 every integer is a double. */
#define EXACT (INT64_C(1) << 53)

double csp_seconds(int64_t nanoseconds)
{
    const bool exact = (nanoseconds >= -EXACT) && (nanoseconds <= EXACT);
    return exact ? (double)nanoseconds / 1e9 : many_seconds(nanoseconds);
}
