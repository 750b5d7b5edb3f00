/* SPDX-License-Identifier: 0BSD */
/* What a simulation needs of the machine that it runs on: csp_simulation_posix.c, or csp_port_board.c. */
#ifndef CSP_SIMULATION_HOST_H
#define CSP_SIMULATION_HOST_H

#include "csp_program.h"

/* The options that only this machine has, for the text about usage. */
extern const char csp_host_options[];

/* Takes such an option. Returns false if there is none of that name, or its value is invalid. */
bool csp_host_option(const char *option, const char *value);

/* To be called when all options are known, before the run. */
void csp_host_begin(void);

/* What changes parameters during the run; NULL: nothing. */
const csp_tuning *csp_host_tuning(void);

/* csp_run, unless the run is steered. */
csp_ending csp_host_run(csp_kernel *csp, int64_t until);

/* The time since any instant, in seconds. */
double csp_host_seconds(void);

/* Writes a text for people. */
void csp_host_say(const char *text);

/* The exit status of the program. */
int csp_host_status(csp_ending ending);

/* A number of an option: digits, and nothing else. */
bool csp_read_number(const char *text, int64_t *number);

#endif
