/* Runs of a program in virtual time against an environment that is compiled in: the main of a simulation. */
#ifndef CSP_SIMULATION_H
#define CSP_SIMULATION_H

#include "csp_program.h"

/* An environment that the program can be run in. */
typedef struct csp_scenario {
    const char *name;
    const csp_environment *environment; /* NULL: a program without ports */
    void (*connect)(void);              /* builds the network with the environment behind its ports */
    bool counts_misses;                 /* missed samples are counted and raise no Timeout */
} csp_scenario;

/* Names and sizes of what is observed, by number; processes and groups count from 1. Empty without CSP_TRACE. */
typedef struct csp_names {
    uint32_t channel_count;
    const char *const *channel_names;
    const uint16_t *channel_sizes;
    uint32_t process_count;
    const char *const *process_names;
    const char *const *process_kinds; /* the definition; "" for a named group */
} csp_names;

/* Runs one of the scenarios, the first unless told otherwise:
 *
 *     --environment NAME    the scenario
 *     --for NANOSECONDS     ends at this time
 *     --parent NUMBER       ends when the process of this number is no longer its parent, and by its SIGTERM
 *     --observe all|ports|none    writes what happens to standard output, in the records of csp_stream.h (with CSP_TRACE)
 *
 * The exit status: 0 if the program ended by itself or at its time limit, 1 if it failed or stands still, 2 for a wrong option; stopped by
 * a signal 128 and its number. */
int csp_simulate(int count, char **options, const csp_program *program, const csp_names *names,
                 const csp_scenario *scenarios, uint32_t scenario_count);

#endif
