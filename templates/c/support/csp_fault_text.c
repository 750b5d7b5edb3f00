/* SPDX-License-Identifier: 0BSD */
/* See csp_fault_text.h. */
#include "csp_fault_text.h"

#include <math.h>

#include "csp_text.h"

/* ---- Texts ---- */

static uint64_t magnitude(int64_t value)
{
    return (value < 0) ? (uint64_t)0 - (uint64_t)value : (uint64_t)value;
}

static void say_range(char *text, size_t size, int64_t low, int64_t high)
{
    csp_append(text, size, " (");
    csp_append_integer(text, size, low);
    csp_append(text, size, " .. ");
    csp_append_integer(text, size, high);
    csp_append(text, size, ")");
}

/* ---- Numbers too large for any type: a sign and limbs of nine decimal digits, the lowest first ---- */

#define LIMB UINT64_C(1000000000)

enum { MOST_LIMBS = 135 }; /* of (2^63)^63 */

typedef struct number {
    bool negative;
    size_t count;
    uint32_t limbs[MOST_LIMBS];
} number;

static void set(number *result, int64_t value)
{
    uint64_t rest = magnitude(value);
    result->negative = value < 0;
    result->count = 0;
    do {
        result->limbs[result->count] = (uint32_t)(rest % LIMB);
        result->count++;
        rest /= LIMB;
    } while (rest > 0U);
}

/* Adds a number of the same sign. */
static void add(number *result, uint64_t summand)
{
    uint64_t carry = summand;
    for (size_t position = 0; carry > 0U; position++) {
        if (position == result->count) {
            result->limbs[position] = 0;
            result->count++;
        }
        const uint64_t limb = result->limbs[position] + (carry % LIMB);
        carry = (carry / LIMB) + (limb / LIMB);
        result->limbs[position] = (uint32_t)(limb % LIMB);
    }
}

static void multiply(number *result, int64_t factor)
{
    /* The products have up to 93 bits, in two halves. */
    const uint64_t low = magnitude(factor) & UINT32_MAX;
    const uint64_t high = magnitude(factor) >> 32U;
    uint64_t carry_low = 0;
    uint64_t carry_high = 0;
    const size_t count = result->count;
    for (size_t position = 0; (position < count) || (carry_low > 0U) || (carry_high > 0U); position++) {
        const uint64_t limb = (position < count) ? result->limbs[position] : 0U;
        const uint64_t sum_low = carry_low + (limb * low);
        const uint64_t sum_high = carry_high + (limb * high) + (sum_low >> 32U);
        const uint64_t rest = ((sum_high % LIMB) << 32U) + (sum_low & UINT32_MAX);
        carry_high = sum_high / LIMB;
        carry_low = rest / LIMB;
        result->limbs[position] = (uint32_t)(rest % LIMB);
        result->count = (position < result->count) ? result->count : position + 1U;
    }
    result->negative = result->negative != (factor < 0);
}

/* Decimal digits of the limbs from `lowest` on. */
static void say_limbs(char *text, size_t size, const number *value, size_t lowest)
{
    for (size_t position = value->count; position > lowest; position--) {
        csp_append_digits(text, size, value->limbs[position - 1U], (position == value->count) ? 1 : 9);
    }
}

/* Nanoseconds in seconds: they are the lowest limb, and no time that is out of range is shorter than a second. */
static void say_outside_time(char *text, size_t size, const number *value)
{
    say_limbs(text, size, value, 1);
    uint32_t fraction = value->limbs[0];
    int digits = 9;
    while ((digits > 0) && ((fraction % 10U) == 0U)) {
        fraction /= 10U;
        digits--;
    }
    if (digits > 0) {
        csp_append(text, size, ".");
        csp_append_digits(text, size, fraction, digits);
    }
    csp_append(text, size, " s is outside time (-9223372036.854775808 s .. 9223372036.854775807 s)");
}

static void say_outside(char *text, size_t size, const number *value, const csp_operands *operands)
{
    text[0] = '\0';
    csp_append(text, size, value->negative ? "-" : "");
    if (operands->name != NULL) {
        say_outside_time(text, size, value);
    } else {
        say_limbs(text, size, value, 0);
        csp_append(text, size, " is outside int");
        say_range(text, size, INT64_MIN, INT64_MAX);
    }
}

void csp_describe_sum(const csp_operands *operands, char *text, size_t size)
{
    number result;
    set(&result, operands->integers[0]);
    add(&result, magnitude(operands->integers[1]));
    say_outside(text, size, &result, operands);
}

void csp_describe_difference(const csp_operands *operands, char *text, size_t size)
{
    number result;
    set(&result, operands->integers[0]);
    add(&result, magnitude(operands->integers[1]));
    say_outside(text, size, &result, operands);
}

void csp_describe_product(const csp_operands *operands, char *text, size_t size)
{
    number result;
    set(&result, operands->integers[0]);
    multiply(&result, operands->integers[1]);
    say_outside(text, size, &result, operands);
}

void csp_describe_power_value(const csp_operands *operands, char *text, size_t size)
{
    number result;
    set(&result, 1);
    for (int64_t count = 0; count < operands->integers[1]; count++) {
        multiply(&result, operands->integers[0]);
    }
    say_outside(text, size, &result, operands);
}

void csp_describe_power(const csp_operands *operands, char *text, size_t size)
{
    text[0] = '\0';
    csp_append_integer(text, size, operands->integers[0]);
    csp_append(text, size, " ^ ");
    csp_append_integer(text, size, operands->integers[1]);
    csp_append(text, size, " is outside int");
}

void csp_describe_negative_exponent(const csp_operands *operands, char *text, size_t size)
{
    text[0] = '\0';
    csp_append(text, size, "negative exponent ");
    csp_append_integer(text, size, operands->integers[1]);
    csp_append(text, size, " of an integer");
}

void csp_describe_division(const csp_operands *operands, char *text, size_t size)
{
    (void)operands;
    text[0] = '\0';
    csp_append(text, size, "division by zero");
}

void csp_describe_real_division(const csp_operands *operands, char *text, size_t size)
{
    (void)operands;
    text[0] = '\0';
    csp_append(text, size, "division by zero");
}

void csp_describe_not_a_number(const csp_operands *operands, char *text, size_t size)
{
    (void)operands;
    text[0] = '\0';
    csp_append(text, size, "a real value is infinite or not a number");
}

void csp_describe_outside(const csp_operands *operands, char *text, size_t size)
{
    text[0] = '\0';
    csp_append_integer(text, size, operands->integers[0]);
    csp_append(text, size, " is outside ");
    csp_append(text, size, operands->name);
    say_range(text, size, operands->integers[1], operands->integers[2]);
}

void csp_describe_index(const csp_operands *operands, char *text, size_t size)
{
    text[0] = '\0';
    csp_append(text, size, "index ");
    csp_append_integer(text, size, operands->integers[0]);
    csp_append(text, size, " is outside 0 .. ");
    csp_append_integer(text, size, operands->integers[1] - 1);
}

/* ---- Reals ---- */

void csp_describe_real_outside(const csp_operands *operands, char *text, size_t size)
{
    text[0] = '\0';
    csp_append_real(text, size, operands->real);
    csp_append(text, size, isfinite(operands->real) ? " is outside " : " is not in ");
    csp_append(text, size, operands->name);
    if (isfinite(operands->real)) {
        say_range(text, size, operands->integers[1], operands->integers[2]);
    }
}

void csp_describe_not_finite(const csp_operands *operands, char *text, size_t size)
{
    text[0] = '\0';
    csp_append_real(text, size, operands->real);
    csp_append(text, size, " is written to ");
    csp_append(text, size, operands->name);
}

void csp_describe_enumerator(const csp_operands *operands, char *text, size_t size)
{
    text[0] = '\0';
    csp_append_integer(text, size, operands->integers[0]);
    csp_append(text, size, " is no value of ");
    csp_append(text, size, operands->name);
}

void csp_describe_not_written(const csp_operands *operands, char *text, size_t size)
{
    text[0] = '\0';
    csp_append(text, size, operands->name);
    csp_append(text, size, " is read before it was written");
}

void csp_describe_not_opened(const csp_operands *operands, char *text, size_t size)
{
    text[0] = '\0';
    csp_append(text, size, "the device ");
    csp_append(text, size, operands->name);
    csp_append(text, size, " could not be opened");
}
