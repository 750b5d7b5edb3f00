/* SPDX-License-Identifier: 0BSD */
/* See csp_simulation_host.h. */
#define _POSIX_C_SOURCE 200809L /* clock_gettime */

#include "csp_simulation_host.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#include "csp_signals.h"
#include "csp_steering.h"
#include "csp_tuning.h"

const char csp_host_options[] = "[--lifeline DESCRIPTOR] [--checks DESCRIPTOR] [--tune FILE] [--steer DESCRIPTOR]";

static int64_t lifeline = -1; /* the descriptor of a pipe at whose end it ends; negative: none */
static int64_t listener = -1; /* the descriptor for a line about each check of the run; negative: none */

bool csp_host_option(const char *option, const char *value)
{
    if (strcmp(option, "--lifeline") == 0) {
        return csp_read_number(value, &lifeline);
    }
    if (strcmp(option, "--tune") == 0) {
        return csp_tuning_open(value);
    }
    if (strcmp(option, "--steer") == 0) {
        return csp_steering_open(value);
    }
    return (strcmp(option, "--checks") == 0) && csp_read_number(value, &listener);
}

void csp_host_begin(void)
{
    csp_signals_begin();
    if (lifeline >= 0) {
        csp_signals_end_with((int)lifeline);
    }
    csp_signals_report((int)listener);
}

const csp_tuning *csp_host_tuning(void)
{
    return csp_tuning_opened();
}

csp_ending csp_host_run(csp_kernel *csp, int64_t until)
{
    return csp_is_steered() ? csp_run_steered(csp, until) : csp_run(csp, until);
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
