/* SPDX-License-Identifier: 0BSD */
/* The main of a simulation: runs a program in virtual time against an environment that is compiled into it. */
#ifndef CSP_SIMULATION_H
#define CSP_SIMULATION_H

#include "csp_program.h"

/* An environment in which the program can run. */
typedef struct csp_scenario {
    const char *name;
    const csp_environment *environment; /* NULL: a program without ports */
    void (*connect)(void);              /* builds the network with its ports connected to the environment */
    bool counts_misses;                 /* missed samples are counted instead of raising Timeout */
} csp_scenario;

/* Names and sizes of everything that is observed, by number; processes and groups are numbered from 1. Empty without CSP_TRACE. */
typedef struct csp_names {
    uint32_t channel_count;
    const char *const *channel_names;
    const uint32_t *channel_sizes;
    uint32_t process_count;
    const char *const *process_names;
    const char *const *process_kinds; /* the definition; "" for a named group */
} csp_names;

/* Runs one of the scenarios, the first by default:
 *
 *     --environment NAME    the scenario
 *     --for NANOSECONDS     ends at this time
 *     --lifeline NUMBER     ends when the other end of the pipe with this descriptor is closed, and by SIGTERM
 *     --tune FILE           changes parameters as the records in the file or pipe say (csp_tuning.h)
 *     --steer NUMBER        advances by the orders in the pipe with this descriptor (csp_steering.h)
 *     --observe all|ports|signals|none    writes events to standard output, in the records of csp_stream.h (with CSP_TRACE)
 *
 * The exit status: 0 if the program ended by itself or at its time limit, 1 if it failed or cannot continue, 2 for a wrong option; 128 plus
 * the number of the signal that stopped it. */
int csp_simulate(int count, char **options, csp_kernel *csp, const csp_names *names,
                 const csp_scenario *scenarios, uint32_t scenario_count);

#endif
