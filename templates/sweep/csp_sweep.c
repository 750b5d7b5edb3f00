/* See csp_sweep.h. */
#define _XOPEN_SOURCE 700 /* POSIX */

#include "csp_sweep.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "csp_arithmetic.h"
#include "csp_sweep_measures.h"

enum { TEXT = 2048 };

static const csp_sweep *sweep;
static csp_sweep_head head;

/* ---- What is observed ---- */

static uint32_t port_count;

void csp_observe(csp_kernel *csp, uint32_t channel, const void *value, uint32_t writer, uint32_t reader)
{
    (void)writer;
    (void)reader;
    if ((channel < port_count) && (csp->program->ports[channel].kind != CSP_PORT_SAMPLED)) {
        csp_sweep_observe_port(csp->now, channel, value);
    }
}

void csp_observe_sample(csp_kernel *csp, uint32_t port, const void *value)
{
    csp_sweep_observe_port(csp->now, port, value);
}

void csp_observe_release(csp_kernel *csp, uint32_t port, const void *value)
{
    (void)csp;
    (void)port;
    (void)value;
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

static bool start_observed(csp_kernel *csp, void *state)
{
    const bool started = (sweep->environment->start == NULL) || sweep->environment->start(csp, state);
    if (started) {
        csp_sweep_observe_states(sweep, 0);
    }
    return started;
}

static bool advance_observed(csp_kernel *csp, void *state, int64_t now)
{
    const bool advanced = (sweep->environment->advance == NULL) || sweep->environment->advance(csp, state, now);
    if (advanced) {
        csp_sweep_observe_states(sweep, now);
    }
    return advanced;
}

/* ---- Runs ---- */

static size_t put_text(char *text, size_t used, const char *part)
{
    const size_t room = (size_t)TEXT - used;
    const size_t length = strlen(part);
    const size_t kept = (length < room) ? length : room - 1U;
    (void)memcpy(&text[used], part, kept);
    text[used + kept] = '\0';
    return used + kept + 1U;
}

/* Exception, message and place of a failure. */
static uint32_t describe(csp_kernel *csp, char *text)
{
    static char part[TEXT / 4];
    const bool raised = csp->error.exception != (uint16_t)CSP_NO_EXCEPTION;
    const bool noted = !raised && csp_faulted(csp);
    size_t used = put_text(text, 0U, raised ? csp_exception_name(csp) : "");
    part[0] = '\0';
    if (raised) {
        csp_describe_message(csp, part, sizeof part);
    } else if (noted) {
        csp->fault.describe(&csp->fault.operands, part, sizeof part);
    } else {
        /* There is nothing to describe. */
    }
    used = put_text(text, used, part);
    part[0] = '\0';
    if (raised) {
        csp_describe_place(csp, part, sizeof part);
    }
    return (uint32_t)put_text(text, used, noted ? csp->fault.place : part);
}

static void count_misses(csp_kernel *csp)
{
    for (uint32_t index = 0; index < csp->program->port_count; index++) {
        const csp_port *const port = &csp->program->ports[index];
        if (port->kind == CSP_PORT_SAMPLED) {
            ((csp_sampled_input *)(void *)csp_medium_of(csp, port))->counts = true;
        }
    }
}

static bool run_once(const void *parameters)
{
    static char text[TEXT];
    csp_kernel *const csp = sweep->csp;
    if (sweep->environment != NULL) {
        (void)memset(sweep->environment->state, 0, sweep->environment_size);
    }
    const bool connected = sweep->connect(parameters);
    csp_program program = *csp->program;
    csp_environment environment = {0, NULL, NULL, NULL, NULL};
    program.reports_misses = true;
    program.environment = sweep->environment;
    if ((sweep->environment != NULL) && (sweep->state_count > 0U)) {
        environment = *sweep->environment;
        environment.start = start_observed;
        environment.advance = advance_observed;
        program.environment = &environment;
    }
    csp->program = &program;
    port_count = program.port_count;
    if (sweep->counts_misses) {
        count_misses(csp);
    }
    csp_sweep_begin_measures();
    csp_sweep_result result = {0, 0, 0U};
    result.ending = (int32_t)(connected ? csp_run(csp, head.until) : CSP_NOT_INITIALIZED);
    result.time = csp->now;
    result.text = (result.ending == (int32_t)CSP_FAILED) ? describe(csp, text) : 0U;
    csp_sweep_end_measures();
    (void)fwrite(&result, sizeof result, 1, stdout);
    for (uint32_t index = 0; index < head.measures; index++) {
        const double value = csp_sweep_measured(index, result.time);
        (void)fwrite(&value, sizeof value, 1, stdout);
    }
    (void)fwrite(text, 1, result.text, stdout);
    return fflush(stdout) == 0;
}

static bool read_all(void *into, size_t size, size_t count)
{
    return fread(into, size, count, stdin) == count;
}

static bool read_measures(void)
{
    csp_sweep_signal *const signals = calloc(head.signals + 1U, sizeof *signals);
    csp_sweep_measure *const wanted = calloc(head.measures + 1U, sizeof *wanted);
    const bool made = (signals != NULL) && (wanted != NULL) && read_all(signals, sizeof *signals, head.signals)
        && read_all(wanted, sizeof *wanted, head.measures)
        && csp_sweep_make_measures(signals, head.signals, wanted, head.measures);
    free(signals);
    free(wanted);
    return made;
}

/* A run may be long, or without an end, and nothing else tells it that nobody waits for its result. */
static void *end_with_parent(void *descriptor)
{
    char byte = 0;
    while ((read(*(const int *)descriptor, &byte, 1) < 0) && (errno == EINTR)) {
    }
    _exit(EXIT_FAILURE);
}

int csp_sweep_run(const csp_sweep *given, int argument_count, char *const *arguments)
{
    static int lifeline;
    pthread_t thread;
    if (argument_count > 1) {
        lifeline = (int)strtol(arguments[1], NULL, 10);
        if (pthread_create(&thread, NULL, end_with_parent, &lifeline) != 0) {
            return EXIT_FAILURE;
        }
    }
    sweep = given;
    const size_t size = (sweep->parameters_size > 0U) ? sweep->parameters_size : 1U;
    void *const parameters = calloc(1, size);
    if ((parameters == NULL) || !read_all(&head, sizeof head, 1) || !read_measures()) {
        return EXIT_FAILURE;
    }
    while (read_all(parameters, size, 1)) {
        if (!run_once(parameters)) {
            return EXIT_FAILURE;
        }
    }
    return EXIT_SUCCESS;
}
