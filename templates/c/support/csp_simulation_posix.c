/* See csp_simulation_host.h. */
#define _POSIX_C_SOURCE 200809L /* clock_gettime */

#include "csp_simulation_host.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#include "csp_signals.h"
#include "csp_tuning.h"

const char csp_host_options[] = "[--parent PID] [--checks DESCRIPTOR] [--tune FILE]";

static int64_t parent;        /* the number of the process at whose end it ends; 0: none */
static int64_t listener = -1; /* the descriptor for a line about each check of the run; negative: none */

bool csp_host_option(const char *option, const char *value)
{
    if (strcmp(option, "--parent") == 0) {
        return csp_read_number(value, &parent);
    }
    if (strcmp(option, "--tune") == 0) {
        return csp_tuning_open(value);
    }
    return (strcmp(option, "--checks") == 0) && csp_read_number(value, &listener);
}

void csp_host_begin(void)
{
    csp_signals_begin();
    if (parent != 0) {
        csp_signals_end_with_parent((long)parent);
    }
    csp_signals_report((int)listener);
}

const csp_tuning *csp_host_tuning(void)
{
    return csp_tuning_opened();
}

double csp_host_seconds(void)
{
    struct timespec present = {0, 0};
    (void)clock_gettime(CLOCK_MONOTONIC, &present);
    return (double)present.tv_sec + ((double)present.tv_nsec / 1e9);
}

void csp_host_say(const char *text)
{
    (void)fputs(text, stderr);
}

int csp_host_status(csp_ending ending)
{
    return csp_exit_status(ending);
}
