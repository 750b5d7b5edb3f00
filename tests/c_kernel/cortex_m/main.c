/* Runs a generated program with a simulated plant and writes its trace: "time channel value", where the value is the bytes of a double or int64_t.
 * Compiled for the bare machine, or for the host in virtual time. */
#include <stdio.h>

#include "csp_port.h"
#include "network.h"
#include ENVIRONMENT_HEADER

#ifdef __arm__
#define WRITE csp_port_write
#else
static void write_text(const char *text)
{
    (void)fputs(text, stdout);
}
#define WRITE write_text
#endif

static char *put_number(char *at, uint64_t number)
{
    char digits[20];
    int count = 0;
    uint64_t rest = number;
    do {
        digits[count] = (char)('0' + (char)(rest % 10U));
        rest /= 10U;
        count++;
    } while (rest > 0U);
    while (count > 0) {
        count--;
        *at = digits[count];
        at++;
    }
    *at = ' ';
    return at + 1;
}

static void write_record(const char *word, uint64_t time, const char *name, uint64_t bits)
{
    char text[160];
    char *at = put_number(text, time);
    while ((*name != '\0') && (at < &text[120])) {
        *at = *name;
        at++;
        name++;
    }
    *at = ' ';
    at = put_number(at + 1, bits);
    at[-1] = '\n';
    at[0] = '\0';
    WRITE(word);
    WRITE(text);
}

void csp_observe(csp_kernel *csp, uint32_t channel, const void *value, uint32_t writer, uint32_t reader)
{
    uint64_t bits = 0U;
    (void)writer;
    (void)reader;
    (void)memcpy(&bits, value, network_channel_sizes[channel]);
    write_record("", (uint64_t)csp->now, network_channel_names[channel], bits);
}

void csp_observe_sample(csp_kernel *csp, uint32_t port, const void *value)
{
    (void)csp;
    (void)port;
    (void)value;
}

void csp_observe_release(csp_kernel *csp, uint32_t port, const void *value)
{
    uint64_t bits = 0U;
    (void)memcpy(&bits, value, network_channel_sizes[port]);
    write_record("release ", (uint64_t)csp->now, network_channel_names[port], bits);
}

void csp_observe_begin(csp_kernel *csp, uint32_t number)
{
    (void)csp;
    (void)number;
}

void csp_observe_end(csp_kernel *csp, uint32_t number)
{
    (void)csp;
    (void)number;
}

static struct network network;

int main(void)
{
    csp_kernel *const csp = &network.kernel;
    csp_program program = network_program;
    program.environment = &ENVIRONMENT;
    network_initialize(&network, &DRIVERS, csp_port_hooks(), NULL);
    csp->program = &program;
    const csp_ending ending = csp_run(csp, DURATION);
    write_record("ended ", (uint64_t)csp->now, "", (uint64_t)ending);
    return 0;
}
