/* The ticker of devices/ticker.csp on the emulated board: a timer of the board, which runs by itself, says when its beats come. */
#include <stdlib.h>

#include "csp_port.h"
#include "ticker_api.h"

#define TIMER_CONTROL (*(volatile uint32_t *)0x40000000U)
#define TIMER_VALUE (*(volatile uint32_t *)0x40000004U)
#define TIMER_RELOAD (*(volatile uint32_t *)0x40000008U)

enum { RUNS = 1, CYCLES_IN_MICROSECOND = 25 };

static ticker_memory memory;
static uint32_t last;
static uint32_t shortest = UINT32_MAX;
static uint32_t longest;

/* Microseconds since the timer began. */
static uint32_t microseconds(void)
{
    return (UINT32_MAX - TIMER_VALUE) / (uint32_t)CYCLES_IN_MICROSECOND;
}

static void say(const char *word, uint32_t number)
{
    char digits[12];
    size_t at = sizeof digits - 1U;
    uint32_t rest = number;
    digits[at] = '\0';
    do {
        at--;
        digits[at] = (char)('0' + (char)(rest % 10U));
        rest /= 10U;
    } while (rest > 0U);
    csp_port_write(word);
    csp_port_write(&digits[at]);
    csp_port_write("\n");
}

/* The emulator, when it counts instructions, sleeps until the interrupt after the next. */
void csp_port_sleep(void)
{
}

static void actuate(void *context, ticker_output output, const ticker_outputs *outputs, bool safe)
{
    const uint32_t present = microseconds();
    const uint32_t distance = present - last;
    (void)context;
    (void)output;
    if (safe) {
        return;
    }
    if (outputs->beat == 0) {
        say("shortest ", shortest);
        say("longest ", longest);
        say("beats until ", last);
        say("waited ", distance);
    } else if (outputs->beat > 1) {
        shortest = (distance < shortest) ? distance : shortest;
        longest = (distance > longest) ? distance : longest;
    } else {
        /* The first one. */
    }
    last = present;
}

int main(void)
{
    static const ticker_hooks hooks = {.real_time = true, .actuate = actuate};
    ticker_state state = TICKER_MORE;
    TIMER_RELOAD = UINT32_MAX;
    TIMER_VALUE = UINT32_MAX;
    TIMER_CONTROL = RUNS;
    csp_port_start();
    ticker_instance *const ticker = ticker_begin(&memory, sizeof memory, &hooks, NULL);
    while (ticker_continues(state)) {
        state = ticker_advance(ticker, csp_port_now(), 64U);
        if (state == TICKER_MORE) {
            csp_port_wait_until(ticker_next(ticker));
        }
    }
    say("state ", (uint32_t)state);
    csp_port_exit(true);
    return 0;
}
