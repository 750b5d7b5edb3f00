/* SPDX-License-Identifier: 0BSD */
/* See csp_text.h. The digits of reals are computed with integers, by the method of Steele and White ("How to print floating-point numbers
 * accurately", 1990) with the refinements of Burger and Dybvig (1996): the fewest digits that are nearer to the number than to its neighbours. */
#include "csp_text.h"

#include <stdbool.h>
#include <string.h>

void csp_append(char *text, size_t size, const char *more)
{
    const size_t length = strlen(text);
    size_t index = 0U;
    while (((length + index + 1U) < size) && (more[index] != '\0')) {
        text[length + index] = more[index];
        index++;
    }
    text[length + index] = '\0';
}

void csp_append_digits(char *text, size_t size, uint64_t value, int least)
{
    char digits[24];
    size_t position = sizeof digits - 1U;
    uint64_t rest = value;
    int count = 0;
    digits[position] = '\0';
    while ((rest > 0U) || (count < least)) {
        position--;
        digits[position] = "0123456789"[rest % 10U];
        rest /= 10U;
        count++;
    }
    csp_append(text, size, &digits[position]);
}

void csp_append_integer(char *text, size_t size, int64_t value)
{
    csp_append(text, size, (value < 0) ? "-" : "");
    csp_append_digits(text, size, (value < 0) ? (uint64_t)0 - (uint64_t)value : (uint64_t)value, 1);
}

/* ---- Integers of up to 1280 bits, the lowest limb first: enough for ten times any double ---- */

enum { LIMBS = 40, SHIFT = 16 };

typedef struct whole {
    uint32_t limbs[LIMBS];
} whole;

static void multiply(whole *number, uint32_t factor)
{
    uint64_t carry = 0U;
    for (size_t limb = 0U; limb < (size_t)LIMBS; limb++) {
        carry += (uint64_t)number->limbs[limb] * factor;
        number->limbs[limb] = (uint32_t)carry;
        carry >>= 32U;
    }
}

static void shift(whole *number, int count)
{
    int rest = count;
    while (rest > 0) {
        const int bits = (rest < (int)SHIFT) ? rest : (int)SHIFT;
        multiply(number, (uint32_t)1U << (unsigned)bits);
        rest -= bits;
    }
}

static void set(whole *number, uint64_t value)
{
    (void)memset(number, 0, sizeof *number);
    number->limbs[0] = (uint32_t)value;
    number->limbs[1] = (uint32_t)(value >> 32U);
}

static void add(whole *number, const whole *summand)
{
    uint64_t carry = 0U;
    for (size_t limb = 0U; limb < (size_t)LIMBS; limb++) {
        carry += (uint64_t)number->limbs[limb] + summand->limbs[limb];
        number->limbs[limb] = (uint32_t)carry;
        carry >>= 32U;
    }
}

/* `number` must not be less than `other`. */
static void subtract(whole *number, const whole *other)
{
    uint64_t borrow = 0U;
    for (size_t limb = 0U; limb < (size_t)LIMBS; limb++) {
        const uint64_t rest = (uint64_t)number->limbs[limb] - other->limbs[limb] - borrow;
        number->limbs[limb] = (uint32_t)rest;
        borrow = (rest >> 32U) & 1U;
    }
}

/* Negative: `one` is less than `other`; 0: they are equal. */
static int compare(const whole *one, const whole *other)
{
    for (size_t limb = LIMBS; limb > 0U; limb--) {
        if (one->limbs[limb - 1U] != other->limbs[limb - 1U]) {
            return (one->limbs[limb - 1U] < other->limbs[limb - 1U]) ? -1 : 1;
        }
    }
    return 0;
}

/* ---- Reals ---- */

enum { MANTISSA = 52, LEAST_EXPONENT = -1074, MOST_DIGITS = 17 };

/* A positive number is `rest / unit`; half of the distances to its neighbours are `below / unit` and `above / unit`. */
typedef struct scaled {
    whole rest;
    whole unit;
    whole below;
    whole above;
    bool even; /* numbers half-way to a neighbour are read as this number */
} scaled;

static void scale(scaled *number, uint64_t mantissa, int exponent)
{
    const bool power = (mantissa == ((uint64_t)1 << (unsigned)MANTISSA)) && (exponent > (int)LEAST_EXPONENT);
    set(&number->rest, mantissa);
    set(&number->unit, 1U);
    set(&number->below, 1U);
    number->even = (mantissa & 1U) == 0U;
    shift(&number->rest, ((exponent > 0) ? exponent : 0) + (power ? 2 : 1));
    shift(&number->unit, ((exponent < 0) ? -exponent : 0) + (power ? 2 : 1));
    shift(&number->below, (exponent > 0) ? exponent : 0);
    number->above = number->below;
    shift(&number->above, power ? 1 : 0);
}

static bool reaches_unit(const scaled *number)
{
    whole sum = number->rest;
    add(&sum, &number->above);
    const int order = compare(&sum, &number->unit);
    return (order > 0) || (number->even && (order == 0));
}

static void multiply_by_ten(scaled *number)
{
    multiply(&number->rest, 10U);
    multiply(&number->below, 10U);
    multiply(&number->above, 10U);
}

/* Divides or multiplies by powers of ten until the first digit is just after the decimal point, and returns the exponent that compensates for it. The number
 * is at least `2 ^ exponent`. */
static int normalize(scaled *number, int exponent)
{
    int power = (exponent >= 0) ? ((exponent * 30103) / 100000) : -(((-exponent * 30103) + 99999) / 100000);
    for (int count = 0; count < power; count++) {
        multiply(&number->unit, 10U);
    }
    for (int count = 0; count > power; count--) {
        multiply_by_ten(number);
    }
    while (reaches_unit(number)) {
        multiply(&number->unit, 10U);
        power++;
    }
    return power;
}

static size_t find_digits(scaled *number, char *digits)
{
    size_t count = 0U;
    bool low = false;
    bool high = false;
    while (!low && !high && (count < (size_t)MOST_DIGITS)) {
        char digit = '0';
        multiply_by_ten(number);
        while (compare(&number->rest, &number->unit) >= 0) {
            subtract(&number->rest, &number->unit);
            digit++;
        }
        const int order = compare(&number->rest, &number->below);
        low = (order < 0) || (number->even && (order == 0));
        high = reaches_unit(number);
        digits[count] = digit;
        count++;
    }
    multiply(&number->rest, 2U);
    const int half = compare(&number->rest, &number->unit);
    const bool odd = ((digits[count - 1U] - '0') % 2) != 0;
    if ((high && !low) || ((high == low) && ((half > 0) || ((half == 0) && odd)))) {
        digits[count - 1U]++;
    }
    digits[count] = '\0';
    return count;
}

/* Appends "0." followed by `digits`, times a power of ten. */
static void append_digits_with_point(char *text, size_t size, const char *digits, size_t count, int power)
{
    if ((power > -4) && (power <= 0)) {
        csp_append(text, size, "0.");
        for (int zero = power; zero < 0; zero++) {
            csp_append(text, size, "0");
        }
        csp_append(text, size, digits);
    } else if ((power > 0) && (power <= 16)) {
        for (size_t position = 0U; position < (size_t)power; position++) {
            const char digit[2] = {(position < count) ? digits[position] : '0', '\0'};
            csp_append(text, size, digit);
        }
        csp_append(text, size, ".");
        csp_append(text, size, (count > (size_t)power) ? &digits[power] : "0");
    } else {
        const char first[2] = {digits[0], '\0'};
        csp_append(text, size, first);
        csp_append(text, size, (count > 1U) ? "." : "");
        csp_append(text, size, &digits[1]);
        csp_append(text, size, (power > 0) ? "e+" : "e-");
        csp_append_digits(text, size, (uint64_t)((power > 0) ? (power - 1) : (1 - power)), 2);
    }
}

static void append_positive(char *text, size_t size, uint64_t mantissa, int exponent)
{
    scaled number;
    char digits[MOST_DIGITS + 1];
    int greatest = exponent - 1; /* the largest power of two that is not greater than the number */
    for (uint64_t rest = mantissa; rest > 0U; rest >>= 1U) {
        greatest++;
    }
    scale(&number, mantissa, exponent);
    const int power = normalize(&number, greatest);
    const size_t count = find_digits(&number, digits);
    append_digits_with_point(text, size, digits, count, power);
}

void csp_append_real(char *text, size_t size, double value)
{
    uint64_t bits = 0U;
    (void)memcpy(&bits, &value, sizeof bits);
    const uint64_t implicit = (uint64_t)1 << (unsigned)MANTISSA;
    const uint64_t fraction = bits & (implicit - 1U);
    const int biased = (int)((bits >> (unsigned)MANTISSA) & 0x7FFU);
    const bool special = biased == 0x7FF;
    csp_append(text, size, (((bits >> 63U) != 0U) && !(special && (fraction != 0U))) ? "-" : "");
    if (special) {
        csp_append(text, size, (fraction != 0U) ? "nan" : "inf");
    } else if ((fraction == 0U) && (biased == 0)) {
        csp_append(text, size, "0.0");
    } else {
        append_positive(text, size, (biased == 0) ? fraction : (fraction | implicit),
                        LEAST_EXPONENT + ((biased == 0) ? 0 : (biased - 1)));
    }
}
