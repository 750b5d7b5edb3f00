/* See csp_fault_text.h. Compiled with CSP_NO_TEXT, for small machines, faults say nothing more than where they happened. */
#include "csp_fault_text.h"

#ifdef CSP_NO_TEXT

#define CSP_SILENT(name)                                                     \
    void name(const csp_operands *operands, char *text, size_t size)         \
    {                                                                        \
        (void)operands;                                                      \
        if (size > 0U) {                                                     \
            text[0] = '\0';                                                  \
        }                                                                    \
    }

CSP_SILENT(csp_describe_sum)
CSP_SILENT(csp_describe_difference)
CSP_SILENT(csp_describe_product)
CSP_SILENT(csp_describe_division)
CSP_SILENT(csp_describe_real_division)
CSP_SILENT(csp_describe_negative_exponent)
CSP_SILENT(csp_describe_power)
CSP_SILENT(csp_describe_power_value)
CSP_SILENT(csp_describe_outside)
CSP_SILENT(csp_describe_real_outside)
CSP_SILENT(csp_describe_index)
CSP_SILENT(csp_describe_not_finite)

#else

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Numbers that are too large for every type: a sign, and decimal digits, the lowest first ---- */

enum { MOST_DIGITS = 1208 }; /* of (2^63)^63 */

typedef struct number {
    bool negative;
    size_t count;
    uint8_t digits[MOST_DIGITS];
} number;

static uint64_t magnitude(int64_t value)
{
    return (value < 0) ? (uint64_t)0 - (uint64_t)value : (uint64_t)value;
}

static void set(number *result, int64_t value)
{
    uint64_t rest = magnitude(value);
    result->negative = value < 0;
    result->count = 0;
    do {
        result->digits[result->count] = (uint8_t)(rest % 10U);
        result->count++;
        rest /= 10U;
    } while (rest > 0U);
}

/* Both of one sign. */
static void add(number *result, uint64_t summand)
{
    uint64_t carry = summand;
    for (size_t position = 0; (carry > 0U) || (position < result->count); position++) {
        if (position == result->count) {
            result->digits[position] = 0;
            result->count++;
        }
        const uint64_t digit = result->digits[position] + (carry % 10U);
        carry = (carry / 10U) + (digit / 10U);
        result->digits[position] = (uint8_t)(digit % 10U);
    }
}

static void multiply(number *result, int64_t factor)
{
    /* 9 times 2^63 and the carry fit in 128 bits only, so in two halves of 32 bits. */
    const uint64_t low = magnitude(factor) & UINT32_MAX;
    const uint64_t high = magnitude(factor) >> 32U;
    uint64_t carry_low = 0;
    uint64_t carry_high = 0;
    const size_t count = result->count;
    for (size_t position = 0; (position < count) || (carry_low > 0U) || (carry_high > 0U); position++) {
        const uint64_t digit = (position < count) ? result->digits[position] : 0U;
        const uint64_t sum_low = carry_low + (digit * low);
        const uint64_t sum_high = carry_high + (digit * high) + (sum_low >> 32U);
        /* Divide the two halves by ten. */
        const uint64_t rest = ((sum_high % 10U) << 32U) + (sum_low & UINT32_MAX);
        carry_high = sum_high / 10U;
        carry_low = rest / 10U;
        result->digits[position] = (uint8_t)(rest % 10U);
        if (position >= result->count) {
            result->count = position + 1U;
        }
        carry_high += carry_low >> 32U;
        carry_low &= UINT32_MAX;
    }
    result->negative = result->negative != (factor < 0);
}

static void outside_int(const number *value, char *text, size_t size)
{
    static char digits[MOST_DIGITS + 1];
    for (size_t position = 0; position < value->count; position++) {
        digits[position] = (char)('0' + value->digits[value->count - 1U - position]);
    }
    digits[value->count] = '\0';
    (void)snprintf(text, size, "%s%s is outside int (%" PRId64 " .. %" PRId64 ")", value->negative ? "-" : "", digits,
                   INT64_MIN, INT64_MAX);
}

static number result;

void csp_describe_sum(const csp_operands *operands, char *text, size_t size)
{
    set(&result, operands->integers[0]);
    add(&result, magnitude(operands->integers[1]));
    outside_int(&result, text, size);
}

void csp_describe_difference(const csp_operands *operands, char *text, size_t size)
{
    set(&result, operands->integers[0]);
    if (operands->integers[0] == 0) {
        result.negative = operands->integers[1] > 0;
    }
    add(&result, magnitude(operands->integers[1]));
    outside_int(&result, text, size);
}

void csp_describe_product(const csp_operands *operands, char *text, size_t size)
{
    set(&result, operands->integers[0]);
    multiply(&result, operands->integers[1]);
    outside_int(&result, text, size);
}

void csp_describe_power_value(const csp_operands *operands, char *text, size_t size)
{
    set(&result, 1);
    for (int64_t count = 0; count < operands->integers[1]; count++) {
        multiply(&result, operands->integers[0]);
    }
    outside_int(&result, text, size);
}

void csp_describe_power(const csp_operands *operands, char *text, size_t size)
{
    (void)snprintf(text, size, "%" PRId64 " ^ %" PRId64 " is outside int", operands->integers[0],
                   operands->integers[1]);
}

void csp_describe_negative_exponent(const csp_operands *operands, char *text, size_t size)
{
    (void)snprintf(text, size, "negative exponent %" PRId64 " of an integer", operands->integers[1]);
}

void csp_describe_division(const csp_operands *operands, char *text, size_t size)
{
    (void)operands;
    (void)snprintf(text, size, "division by zero");
}

void csp_describe_real_division(const csp_operands *operands, char *text, size_t size)
{
    (void)operands;
    (void)snprintf(text, size, "float division by zero");
}

void csp_describe_outside(const csp_operands *operands, char *text, size_t size)
{
    (void)snprintf(text, size, "%" PRId64 " is outside %s (%" PRId64 " .. %" PRId64 ")", operands->integers[0],
                   operands->name, operands->integers[1], operands->integers[2]);
}

void csp_describe_index(const csp_operands *operands, char *text, size_t size)
{
    (void)snprintf(text, size, "index %" PRId64 " is outside 0 .. %" PRId64, operands->integers[0],
                   operands->integers[1] - 1);
}

/* ---- Reals, in the fewest digits that say them ---- */

enum { REAL_TEXT = 32 };

/* d.ddde+xx, in as few digits as are read as the same number. */
static void shortest(double value, char *text)
{
    for (int digits = 0; digits < 17; digits++) {
        (void)snprintf(text, REAL_TEXT, "%.*e", digits, value);
        if (strtod(text, NULL) == value) {
            return;
        }
    }
}

/* As every target writes reals: 0.5, 1e+16, -2.0. */
static void real_text(double value, char *text)
{
    if (!isfinite(value)) {
        (void)snprintf(text, REAL_TEXT, "%s", isnan(value) ? "nan" : ((value < 0.0) ? "-inf" : "inf"));
        return;
    }
    shortest(value, text);
    char *const mark = strchr(text, 'e');
    const long exponent = strtol(mark + 1, NULL, 10);
    const int digits = (int)(mark - text) - ((text[0] == '-') ? 1 : 0);
    if ((exponent < -4) || (exponent >= 16)) {
        return;
    }
    /* One digit before the point and `digits - 2` behind it; without the exponent there are fewer or more behind. */
    const int behind = ((digits > 1) ? digits - 2 : 0) - (int)exponent;
    (void)snprintf(text, REAL_TEXT, "%.*f", (behind > 1) ? behind : 1, value);
}

void csp_describe_real_outside(const csp_operands *operands, char *text, size_t size)
{
    char value[REAL_TEXT];
    real_text(operands->real, value);
    if (!isfinite(operands->real)) {
        (void)snprintf(text, size, "%s is not in %s", value, operands->name);
        return;
    }
    (void)snprintf(text, size, "%s is outside %s (%" PRId64 " .. %" PRId64 ")", value, operands->name,
                   operands->integers[1], operands->integers[2]);
}

void csp_describe_not_finite(const csp_operands *operands, char *text, size_t size)
{
    char value[REAL_TEXT];
    real_text(operands->real, value);
    (void)snprintf(text, size, "%s is written to %s", value, operands->name);
}

#endif
