/* Writes the bits of all differences between some doubles, two words each, and how they compare. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "csp_port.h"

static const volatile uint64_t values[] = {
    UINT64_C(0), UINT64_C(0x8000000000000000),                  /* zeros */
    UINT64_C(0x3FF0000000000000), UINT64_C(0xBFF0000000000001), /* 1, and -1 with its last bit */
    UINT64_C(1), UINT64_C(0x800FFFFFFFFFFFFF),                  /* subnormal */
    UINT64_C(0x7FEFFFFFFFFFFFFF), UINT64_C(0xFFE0000000000000), /* large */
    UINT64_C(0x4341C37937E08001), UINT64_C(0x3FB999999999999A), /* 1e16 and a half, 0.1 */
    UINT64_C(0x7FF0000000000000), UINT64_C(0xFFF0000000000000), /* infinite */
    UINT64_C(0x7FF8000000000000), UINT64_C(0xFFF0000000000001)  /* not numbers */
};

enum { COUNT = sizeof values / sizeof values[0] };

static double value_of(uint64_t bits)
{
    double value = 0.0;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}

/* Letters of the operators that hold. */
static void compare(double one, double other, char text[7])
{
    size_t length = 0U;
    if (one == other) {
        text[length++] = '=';
    }
    if (one < other) {
        text[length++] = '<';
    }
    if (one <= other) {
        text[length++] = 'l';
    }
    if (one > other) {
        text[length++] = '>';
    }
    if (one >= other) {
        text[length++] = 'g';
    }
    text[length++] = '.';
    text[length] = '\0';
}

int main(void)
{
    for (uint32_t left = 0U; left < (uint32_t)COUNT; left++) {
        for (uint32_t right = 0U; right < (uint32_t)COUNT; right++) {
            const uint64_t one = values[left];
            const uint64_t other = values[right];
            const double difference = value_of(one) - value_of(other);
            uint64_t bits = 0U;
            char compared[7] = "";
            char line[90] = "";
            (void)memcpy(&bits, &difference, sizeof bits);
            compare(value_of(one), value_of(other), compared);
            (void)snprintf(line, sizeof line, "%08" PRIx32 "%08" PRIx32 " %08" PRIx32 "%08" PRIx32 " %08" PRIx32 "%08" PRIx32 " %s\n",
                           (uint32_t)(one >> 32U), (uint32_t)one, (uint32_t)(other >> 32U), (uint32_t)other,
                           (uint32_t)(bits >> 32U), (uint32_t)bits, compared);
            csp_port_write(line);
        }
    }
    csp_port_exit(true);
    return 0;
}
