/* See csp_sweep.h. */
#define _XOPEN_SOURCE 700 /* POSIX */

#include "csp_sweep.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "csp_arithmetic.h"

enum { TEXT = 2048 };

typedef struct signal {
    csp_sweep_signal is;
    double value; /* NAN: none yet */
} signal;

typedef struct measure {
    csp_sweep_measure is;
    bool changed;  /* at the present instant */
    int64_t since; /* the instant of the value; negative: none yet */
    int64_t first; /* that of the first value */
    double value;
    double result; /* of max, min, peak, mean, ..., as far as it is known */
    double begun;  /* overshoot: the first value; settling: when it came within the tolerance; NAN: it is not */
} measure;

static const csp_sweep *sweep;
static csp_sweep_head head;
static signal *signals;
static measure *measures;
static int64_t observed_at; /* the instant of the last observation */

static double number_at(const void *place, uint32_t type)
{
    switch (type) {
    case 'd':
        return *(const double *)place;
    case 'f':
        return (double)*(const float *)place;
    case '?':
        return *(const bool *)place ? 1.0 : 0.0;
    case 'b':
        return (double)*(const int8_t *)place;
    case 'B':
        return (double)*(const uint8_t *)place;
    case 'h':
        return (double)*(const int16_t *)place;
    case 'H':
        return (double)*(const uint16_t *)place;
    case 'i':
        return (double)*(const int32_t *)place;
    case 'I':
        return (double)*(const uint32_t *)place;
    case 'Q':
        return (double)*(const uint64_t *)place;
    case 'T':
        return csp_seconds(*(const int64_t *)place);
    default:
        return (double)*(const int64_t *)place;
    }
}

/* ---- Measures ---- */

/* What the value that is held until `now` adds to an integral. */
static void hold(measure *self, int64_t now)
{
    const double held = csp_seconds(now - self->since);
    switch (self->is.kind) {
    case CSP_SWEEP_MEAN:
    case CSP_SWEEP_INTEGRAL:
        self->result += self->value * held;
        break;
    case CSP_SWEEP_RMS:
        self->result += (self->value * self->value) * held;
        break;
    default:
        break; /* only its values count */
    }
}

static void begin(measure *self, int64_t now, double value)
{
    self->first = now;
    switch (self->is.kind) {
    case CSP_SWEEP_PEAK:
        self->result = fabs(value);
        break;
    case CSP_SWEEP_MEAN:
    case CSP_SWEEP_RMS:
    case CSP_SWEEP_INTEGRAL:
        self->result = 0.0;
        break;
    case CSP_SWEEP_OVERSHOOT:
        self->begun = value;
        self->result = 0.0;
        break;
    default:
        self->result = value;
        break;
    }
}

static double beyond(const measure *self, double value)
{
    const double target = self->is.target;
    if (self->begun < target) {
        return value - target;
    }
    return (self->begun > target) ? target - value : fabs(value - target);
}

static void take(measure *self, int64_t now, double value)
{
    if (self->since < 0) {
        begin(self, now, value);
    } else {
        hold(self, now);
    }
    self->since = now;
    self->value = value;
    switch (self->is.kind) {
    case CSP_SWEEP_MAX:
        self->result = (value > self->result) ? value : self->result;
        break;
    case CSP_SWEEP_MIN:
        self->result = (value < self->result) ? value : self->result;
        break;
    case CSP_SWEEP_PEAK:
        self->result = (fabs(value) > self->result) ? fabs(value) : self->result;
        break;
    case CSP_SWEEP_LAST:
        self->result = value;
        break;
    case CSP_SWEEP_SETTLING:
        if (!(fabs(value - self->is.target) <= self->is.tolerance)) {
            self->begun = NAN;
        } else if (isnan(self->begun)) {
            self->begun = csp_seconds(now);
        } else {
            /* It stays. */
        }
        break;
    case CSP_SWEEP_OVERSHOOT:
        self->result = (beyond(self, value) > self->result) ? beyond(self, value) : self->result;
        break;
    default:
        break; /* integrals are taken when it is known how long the value was held */
    }
}

static double finished(measure *self, int64_t end)
{
    if (self->since < 0) {
        return NAN;
    }
    hold(self, end);
    const double length = csp_seconds(end - self->first);
    switch (self->is.kind) {
    case CSP_SWEEP_MEAN:
        return (length > 0.0) ? self->result / length : self->value;
    case CSP_SWEEP_RMS:
        return (length > 0.0) ? sqrt(self->result / length) : fabs(self->value);
    case CSP_SWEEP_SETTLING:
        return self->begun;
    default:
        return self->result;
    }
}

/* Gives measures the values of the instant that is over. */
static void close_instant(void)
{
    for (uint32_t index = 0; index < head.measures; index++) {
        measure *const self = &measures[index];
        if (self->changed) {
            self->changed = false;
            double value = signals[self->is.signal].value;
            if (self->is.subtracted != CSP_SWEEP_NOTHING) {
                value -= signals[self->is.subtracted].value;
            }
            if (!isnan(value)) { /* both are known */
                take(self, observed_at, (self->is.absolute != 0U) ? fabs(value) : value);
            }
        }
    }
}

/* A new instant closes the one before. */
static void reach(int64_t now)
{
    if (now != observed_at) {
        close_instant();
        observed_at = now;
    }
}

static void set(uint32_t index, const void *value)
{
    signal *const self = &signals[index];
    self->value = number_at((const char *)value + self->is.offset, self->is.type);
    for (uint32_t at = 0; at < head.measures; at++) {
        if ((measures[at].is.signal == index) || (measures[at].is.subtracted == index)) {
            measures[at].changed = true;
        }
    }
}

static void observe_port(int64_t now, uint32_t port, const void *value)
{
    reach(now);
    for (uint32_t index = 0; index < head.signals; index++) {
        if ((signals[index].is.state == 0U) && (signals[index].is.number == port)) {
            set(index, value);
        }
    }
}

static void observe_states(int64_t now)
{
    reach(now);
    for (uint32_t index = 0; index < head.signals; index++) {
        if (signals[index].is.state != 0U) {
            const size_t place = sweep->states[signals[index].is.number];
            set(index, (const char *)sweep->environment->state + place);
        }
    }
}

static void begin_measures(void)
{
    observed_at = 0;
    for (uint32_t index = 0; index < head.signals; index++) {
        signals[index].value = NAN;
    }
    for (uint32_t index = 0; index < head.measures; index++) {
        measures[index] = (measure){.is = measures[index].is, .since = -1, .begun = NAN};
    }
}

/* ---- What is observed ---- */

static uint32_t port_count;

void csp_observe(csp_kernel *csp, uint32_t channel, const void *value, uint32_t writer, uint32_t reader)
{
    (void)writer;
    (void)reader;
    if ((channel < port_count) && (csp->program->ports[channel].kind != CSP_PORT_SAMPLED)) {
        observe_port(csp->now, channel, value);
    }
}

void csp_observe_sample(csp_kernel *csp, uint32_t port, const void *value)
{
    observe_port(csp->now, port, value);
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
        observe_states(0);
    }
    return started;
}

static bool advance_observed(csp_kernel *csp, void *state, int64_t now)
{
    const bool advanced = (sweep->environment->advance == NULL) || sweep->environment->advance(csp, state, now);
    if (advanced) {
        observe_states(now);
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
    begin_measures();
    csp_sweep_result result = {0, 0, 0U};
    result.ending = (int32_t)(connected ? csp_run(csp, head.until) : CSP_NOT_INITIALIZED);
    result.time = csp->now;
    result.text = (result.ending == (int32_t)CSP_FAILED) ? describe(csp, text) : 0U;
    close_instant();
    (void)fwrite(&result, sizeof result, 1, stdout);
    for (uint32_t index = 0; index < head.measures; index++) {
        const double value = finished(&measures[index], result.time);
        (void)fwrite(&value, sizeof value, 1, stdout);
    }
    (void)fwrite(text, 1, result.text, stdout);
    return fflush(stdout) == 0;
}

static bool read_all(void *into, size_t size, size_t count)
{
    return fread(into, size, count, stdin) == count;
}

static bool read_tasks(void)
{
    csp_sweep_signal *const given = calloc(head.signals + 1U, sizeof *given);
    csp_sweep_measure *const wanted = calloc(head.measures + 1U, sizeof *wanted);
    signals = calloc(head.signals + 1U, sizeof *signals);
    measures = calloc(head.measures + 1U, sizeof *measures);
    if ((given == NULL) || (wanted == NULL) || (signals == NULL) || (measures == NULL) ||
        !read_all(given, sizeof *given, head.signals) || !read_all(wanted, sizeof *wanted, head.measures)) {
        return false;
    }
    for (uint32_t index = 0; index < head.signals; index++) {
        signals[index].is = given[index];
    }
    for (uint32_t index = 0; index < head.measures; index++) {
        measures[index].is = wanted[index];
    }
    free(given);
    free(wanted);
    return true;
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
    if ((parameters == NULL) || !read_all(&head, sizeof head, 1) || !read_tasks()) {
        return EXIT_FAILURE;
    }
    while (read_all(parameters, size, 1)) {
        if (!run_once(parameters)) {
            return EXIT_FAILURE;
        }
    }
    return EXIT_SUCCESS;
}
