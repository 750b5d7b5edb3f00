/* SPDX-License-Identifier: 0BSD */
/* See csp_simulation.h. */
#include "csp_simulation.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "csp_arithmetic.h"
#include "csp_simulation_host.h"
#include "csp_stream.h"

enum { EXIT_WRONG_OPTION = 2, TEXT = 2048 };

typedef struct request {
    const char *environment;
    int64_t until; /* negative: without limit */
    csp_observed observed;
} request;

bool csp_read_number(const char *text, int64_t *number)
{
    char *end = NULL;
    errno = 0;
    const long long value = strtoll(text, &end, 10);
    *number = (int64_t)value;
    return (errno == 0) && (end != text) && (*end == '\0') && (value >= 0);
}

static bool read_observed(const char *text, csp_observed *observed)
{
    static const char *const words[] = {"none", "signals", "ports", "all"};
    for (size_t index = 0; index < sizeof words / sizeof words[0]; index++) {
        if (strcmp(text, words[index]) == 0) {
            *observed = (csp_observed)(index + 1U);
            return true;
        }
    }
    return false;
}

static bool read_options(int count, char **options, request *parsed)
{
    for (int index = 1; index < count; index += 2) {
        const char *const option = options[index];
        const char *const value = (index + 1 < count) ? options[index + 1] : NULL;
        bool valid = value != NULL;
        if (!valid) {
            /* Every option has a value. */
        } else if (strcmp(option, "--environment") == 0) {
            parsed->environment = value;
        } else if (strcmp(option, "--for") == 0) {
            valid = csp_read_number(value, &parsed->until);
        } else if (strcmp(option, "--observe") == 0) {
            valid = read_observed(value, &parsed->observed);
        } else {
            valid = csp_host_option(option, value);
        }
        if (!valid) {
            csp_host_say("usage: ");
            csp_host_say(options[0]);
            csp_host_say(" [--environment NAME] [--for NANOSECONDS] [--observe all|ports|signals|none] ");
            csp_host_say(csp_host_options);
            csp_host_say("\n");
            return false;
        }
    }
    return true;
}

static const csp_scenario *find(const csp_scenario *scenarios, uint32_t count, const char *name)
{
    for (uint32_t index = 0; index < count; index++) {
        if (strcmp(scenarios[index].name, name) == 0) {
            return &scenarios[index];
        }
    }
    csp_host_say("no environment ");
    csp_host_say(name);
    csp_host_say("; there are:");
    for (uint32_t index = 0; index < count; index++) {
        csp_host_say(" ");
        csp_host_say(scenarios[index].name);
    }
    csp_host_say("\n");
    return NULL;
}

static void count_misses(csp_kernel *csp)
{
    const csp_program *const program = csp->program;
    for (uint32_t index = 0; index < program->port_count; index++) {
        if (program->ports[index].kind == CSP_PORT_SAMPLED) {
            ((csp_sampled_input *)(void *)csp_medium_of(csp, &program->ports[index]))->counts = true;
        }
    }
}

static void show_waiting(csp_kernel *csp, const csp_waiting_process *waiting, void *context)
{
    (void)context;
    char text[TEXT] = "";
    csp_describe_waiting(csp, waiting, text, sizeof text);
    csp_host_say("  ");
    csp_host_say(text);
    csp_host_say("\n");
}

static void show_missed(csp_kernel *csp)
{
    char text[TEXT] = "";
    csp_describe_missed(csp, text, sizeof text);
    csp_host_say("  missed samples: ");
    csp_host_say(text);
    csp_host_say("\n");
}

/* Describes the failure of a process, or of the environment, whose faults remain in `csp->fault`. */
static void describe_failure(csp_kernel *csp, char *text, size_t size)
{
    if (csp->error.exception != (uint16_t)CSP_NO_EXCEPTION) {
        csp_describe_error(csp, text, size);
    } else if (csp_faulted(csp)) {
        csp->fault.describe(&csp->fault.operands, text, size);
    } else {
        (void)snprintf(text, size, "the environment has failed");
    }
}

static void show(csp_kernel *csp, csp_ending ending, double duration)
{
    static const char *const endings[] = {"ended by itself", "ended unsuccessfully", "deadlock",
                                          "reached the time limit", "stopped", "not initialized"};
    const double simulated = csp_seconds(csp->now);
    char text[TEXT] = "";
    (void)snprintf(text, sizeof text, "%s at %.9g s", endings[ending], simulated);
    csp_host_say(text);
    if (ending == CSP_FAILED) {
        describe_failure(csp, text, sizeof text);
        csp_host_say(": ");
        csp_host_say(text);
    }
    (void)snprintf(text, sizeof text, "\n  simulated in %.3g s, %.0f times real time\n", duration, simulated / duration);
    csp_host_say(text);
    if (ending == CSP_DEADLOCK) {
        csp_report_waiting(csp, show_waiting, NULL);
    }
    show_missed(csp);
}

int csp_simulate(int count, char **options, csp_kernel *csp, const csp_names *names,
                 const csp_scenario *scenarios, uint32_t scenario_count)
{
    request parsed = {NULL, -1, CSP_SILENT};
    if (!read_options(count, options, &parsed)) {
        return EXIT_WRONG_OPTION;
    }
    const csp_scenario *const scenario =
        (parsed.environment == NULL) ? scenarios : find(scenarios, scenario_count, parsed.environment);
    if (scenario == NULL) {
        return EXIT_WRONG_OPTION;
    }
    scenario->connect();
    static csp_program program; /* handlers may look at it until the process ends */
    program = *csp->program;
    program.reports_misses = true;
    program.environment = scenario->environment;
    program.tuning = (program.set_parameters != NULL) ? csp_host_tuning() : NULL;
    csp->program = &program;
    if (scenario->counts_misses) {
        count_misses(csp);
    }
    csp_own(csp);
    csp_host_begin();
    csp_stream_begin(csp, names, parsed.observed);
    if (program.tuning != NULL) {
        program.tuning->make(csp, 0);
    }
    const double began = csp_host_seconds();
    const csp_ending ending = csp_host_run(csp, parsed.until);
    const double duration = csp_host_seconds() - began;
    const int status = csp_host_status(ending);
    if (parsed.observed == CSP_SILENT) {
        show(csp, ending, duration);
    } else if (!csp_stream_end(csp, ending, duration)) {
        csp_host_say("could not write everything to standard output\n");
        return (status == EXIT_SUCCESS) ? EXIT_FAILURE : status;
    } else {
        /* It has been reported. */
    }
    return status;
}
