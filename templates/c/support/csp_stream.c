/* SPDX-License-Identifier: 0BSD */
/* See csp_stream.h. */
#define _POSIX_C_SOURCE 200809L /* with CSP_MEASURE: a clock for the processor time of this program */

#include "csp_stream.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "csp_arithmetic.h"
#include "csp_internal.h"
#include "csp_stream_rows.h"
#include "csp_shared.h"

enum { PAYLOAD = 24, TEXT = 2048 };

enum {
    CONTINUATION,
    CHANNEL,
    PROCESS,
    COMMUNICATION,
    BEGIN,
    END,
    RELEASE,
    TEXT_OF_RECORD,
    WAITING,
    MISSED,
    END_OF_RUN,
    EXECUTION_TIME,
    SAMPLE,
    WAITING_AT,
    PRESENT,
    CHANGED
};

static bool silent;
static uint64_t communications;

#if CSP_MEASURE

static int64_t reporting; /* nanoseconds that were spent on writing records, which do not count as execution time */

static int64_t time_used(void)
{
    struct timespec present;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &present);
    return ((int64_t)present.tv_sec * INT64_C(1000000000)) + (int64_t)present.tv_nsec;
}

static void flush(csp_kernel *csp)
{
    const int64_t before = time_used();
    csp_rows_send(csp);
    reporting += time_used() - before;
}

#else

static void flush(csp_kernel *csp)
{
    csp_rows_send(csp);
}

#endif

static void completes(void)
{
    CSP_STORE_AFTER(csp_rows.complete, csp_rows.filled);
}

/* Adds a row. A record that is longer than the buffer is sent in pieces. */
static csp_row *add_row(csp_kernel *csp, uint32_t kind, uint32_t number)
{
    if (csp_rows.filled == (size_t)CSP_ROWS) {
        flush(csp);
    }
    if (csp_rows.filled == (size_t)CSP_ROWS) {
        completes();
        flush(csp);
    }
    csp_row *const added = &csp_rows.of[csp_rows.filled];
    csp_rows.filled++;
    added->kind = kind;
    added->number = number;
    return added;
}

/* Begins a record where the last complete one ends, discarding an incomplete one. */
static csp_row *begin_record(csp_kernel *csp, uint32_t kind, uint32_t number)
{
    csp_rows.filled = csp_rows.complete;
    csp_row *const added = add_row(csp, kind, number);
    added->time = csp->now;
    added->writer = 0;
    added->reader = 0;
    added->value = 0;
    return added;
}

/* Puts as many of the bytes as there is room for into a row, in place of the fields from its time on. Returns how many. */
static size_t put_payload(csp_row *into, const unsigned char *bytes, size_t size)
{
    unsigned char *const payload = (unsigned char *)into + offsetof(csp_row, time);
    const size_t count = (size < (size_t)PAYLOAD) ? size : (size_t)PAYLOAD;
    (void)memcpy(payload, bytes, count);
    (void)memset(&payload[count], 0, (size_t)PAYLOAD - count);
    return count;
}

static void put_rest(csp_kernel *csp, const unsigned char *bytes, size_t size)
{
    size_t done = 0U;
    while (done < size) {
        done += put_payload(add_row(csp, CONTINUATION, 0), &bytes[done], size - done);
    }
}

static void put_text(csp_kernel *csp, const char *text)
{
    const unsigned char *const bytes = (const unsigned char *)((text != NULL) ? text : "");
    const size_t length = strlen((const char *)bytes);
    const size_t begun = put_payload(add_row(csp, TEXT_OF_RECORD, (uint32_t)length), bytes, length);
    put_rest(csp, &bytes[begun], length - begun);
}

#if CSP_TRACE

static const csp_names *known;
static const csp_port *ports;
static uint32_t observed_channels;
static uint32_t named_channels;
static bool only_signals;

static void put_value(csp_kernel *csp, uint32_t kind, uint32_t channel, const void *value, uint32_t writer, uint32_t reader)
{
    const size_t size = known->channel_sizes[channel];
    csp_row *const added = begin_record(csp, kind, channel);
    added->writer = writer;
    added->reader = reader;
    if (size == sizeof added->value) { /* a constant size, which is faster */
        (void)memcpy(&added->value, value, sizeof added->value);
    } else if (size < sizeof added->value) {
        (void)memcpy(&added->value, value, size);
    } else {
        const unsigned char *const bytes = (const unsigned char *)value;
        (void)memcpy(&added->value, bytes, sizeof added->value);
        put_rest(csp, &bytes[sizeof added->value], size - sizeof added->value);
    }
    completes();
}

void csp_observe(csp_kernel *csp, uint32_t channel, const void *value, uint32_t writer, uint32_t reader)
{
    if ((channel < observed_channels) && !(only_signals && (ports[channel].kind == CSP_PORT_SAMPLED))) {
        put_value(csp, COMMUNICATION, channel, value, writer, reader);
        communications++;
    }
}

void csp_observe_sample(csp_kernel *csp, uint32_t port, const void *value)
{
    if (port < observed_channels) {
        put_value(csp, SAMPLE, port, value, 0, 0);
    }
}

void csp_observe_release(csp_kernel *csp, uint32_t port, const void *value)
{
    if (port < observed_channels) {
        put_value(csp, RELEASE, port, value, 0, 0);
    }
}

static void begins_or_ends(csp_kernel *csp, uint32_t kind, uint32_t number)
{
    if (!silent) {
        (void)begin_record(csp, kind, number);
        completes();
    }
}

void csp_observe_begin(csp_kernel *csp, uint32_t number)
{
    begins_or_ends(csp, BEGIN, number);
}

void csp_observe_end(csp_kernel *csp, uint32_t number)
{
    begins_or_ends(csp, END, number);
}

/* Writes the names of the channels before `end` that have not been named yet. */
static void name_channels(csp_kernel *csp, uint32_t end)
{
    for (; named_channels < end; named_channels++) {
        begin_record(csp, CHANNEL, named_channels)->writer = known->channel_sizes[named_channels];
        put_text(csp, known->channel_names[named_channels]);
        completes();
    }
}

/* A waiting process may wait at any channel, observed or not. */
static void name_all_channels(csp_kernel *csp)
{
    name_channels(csp, known->channel_count);
}

void csp_stream_begin(csp_kernel *csp, const csp_names *names, csp_observed observed)
{
    silent = observed == CSP_SILENT;
    csp_rows_begin();
    observed_channels = 0;
    if (silent) {
        return;
    }
    known = names;
    ports = csp->program->ports;
    only_signals = observed == CSP_OBSERVE_SIGNALS;
    if (observed != CSP_OBSERVE_NONE) {
        observed_channels = (observed == CSP_OBSERVE_ALL) ? names->channel_count : csp->program->port_count;
    }
    named_channels = 0;
    name_channels(csp, (observed_channels > csp->program->port_count) ? observed_channels : csp->program->port_count);
    for (uint32_t number = 1; number <= names->process_count; number++) {
        (void)begin_record(csp, PROCESS, number);
        put_text(csp, names->process_names[number]);
        put_text(csp, names->process_kinds[number]);
        completes();
    }
}

#else

void csp_stream_begin(csp_kernel *csp, const csp_names *names, csp_observed observed)
{
    (void)csp;
    (void)names;
    silent = observed == CSP_SILENT;
    csp_rows_begin();
}

static void name_all_channels(csp_kernel *csp)
{
    (void)csp;
    /* Without CSP_TRACE channels have no names. */
}

#endif

/* The samples that were missed until now, of inputs that have missed at least `least`. */
static void report_misses(csp_kernel *csp, uint32_t least)
{
    for (uint32_t index = 0; index < csp->program->port_count; index++) {
        if (csp->program->ports[index].kind == CSP_PORT_SAMPLED) {
            const csp_medium *const medium = csp_medium_of(csp, &csp->program->ports[index]);
            const uint32_t missed = ((const csp_sampled_input *)(const void *)medium)->missed;
            if (missed >= least) {
                begin_record(csp, MISSED, medium->number)->writer = missed;
                completes();
            }
        }
    }
}

void csp_stream_present(csp_kernel *csp)
{
    if (!silent) {
        report_misses(csp, 1U);
        (void)begin_record(csp, PRESENT, 0);
        completes();
    }
}

void csp_stream_held(csp_kernel *csp, bool reached, int64_t next)
{
    report_misses(csp, 1U);
    csp_row *const added = begin_record(csp, PRESENT, 0);
    added->writer = 1U;
    added->reader = reached ? 1U : 0U;
    added->value = (uint64_t)next;
    completes();
    flush(csp);
}

uint64_t csp_stream_communications(void)
{
    return communications;
}

void csp_stream_change(csp_kernel *csp, uint32_t number, int64_t instant, bool made)
{
    if (!silent) {
        csp_row *const added = begin_record(csp, CHANGED, number);
        added->time = instant;
        added->value = made ? 1U : 0U;
        completes();
    }
}

/* Whether the writer of a broadcast waits for this end: to take the value, or, with an output guard, to be read from. */
static bool is_missing(const csp_broadcast *channel, const csp_broadcast_end *end)
{
    return (channel->writer != NULL) ? end->fresh : ((end->reader == NULL) && (end->waiting == NULL));
}

/* A process that has been reported waits at a channel. If it waits to write to a broadcast: which of its ends are missing, numbered from 0 in the order
 * in which they are served. */
static void report_waiting_at(csp_kernel *csp, const csp_wait_entry *entry)
{
    const csp_broadcast *const channel =
        (entry->medium->kind == (uint8_t)CSP_BROADCAST) ? (const csp_broadcast *)(const void *)entry->medium : NULL;
    uint32_t index = 0;
    begin_record(csp, WAITING_AT, entry->channel)->writer = UINT32_MAX;
    completes();
    for (const csp_broadcast_end *end = (channel != NULL) ? channel->ends : NULL; end != NULL; end = end->next) {
        if (is_missing(channel, end)) {
            begin_record(csp, WAITING_AT, entry->channel)->writer = index;
            completes();
        }
        index++;
    }
}

static void report_waiting_process(csp_kernel *csp, const csp_waiting_process *waiting, void *context)
{
    (void)context;
    char text[TEXT] = "";
    csp_wait_entry entry;
    name_all_channels(csp);
    (void)begin_record(csp, WAITING, waiting->process->party.number);
    if (csp->program->process_name != NULL) {
        csp->program->process_name(waiting->process->party.number, text, sizeof text);
    }
    put_text(csp, text);
    put_text(csp, waiting->process->kind->where);
    put_text(csp, waiting->place->where);
    csp_describe_waiting(csp, waiting, text, sizeof text);
    put_text(csp, text);
    completes();
    for (uint32_t index = 0; csp_wait_of(waiting, index, &entry); index++) {
        if (entry.named) {
            report_waiting_at(csp, &entry);
        }
    }
}

static bool is_ready(csp_kernel *csp, const csp_party *party)
{
    for (uint32_t level = 0U; level < (uint32_t)CSP_LEVELS; level++) {
        for (const csp_party *ready = csp->ready[level].first; ready != NULL; ready = ready->next) {
            if (ready == party) {
                return true;
            }
        }
    }
    return false;
}

static void report_if_waiting(csp_kernel *csp, const csp_waiting_process *waiting, void *context)
{
    csp_wait_entry entry;
    csp_process *const process = (csp_process *)(uintptr_t)(const void *)waiting->process;
    if (csp_wait_of(waiting, 0U, &entry) && !is_ready(csp, &csp_task_of(process)->party)) {
        report_waiting_process(csp, waiting, context);
    }
}

void csp_stream_waiting(csp_kernel *csp)
{
    csp_report_waiting(csp, report_if_waiting, NULL);
}

/* Writes exception, message and place. A fault of the environment remains in `csp_fault`. */
static void put_failure(csp_kernel *csp, bool failed)
{
    char text[TEXT] = "";
    const bool raised = failed && (csp->error.exception != (uint16_t)CSP_NO_EXCEPTION);
    const bool noted = failed && !raised && csp_faulted(csp);
    put_text(csp, raised ? csp_exception_name(csp) : "");
    if (raised) {
        csp_describe_message(csp, text, sizeof text);
    } else if (noted) {
        csp->fault.describe(&csp->fault.operands, text, sizeof text);
    } else {
        /* There is nothing to report. */
    }
    put_text(csp, text);
    text[0] = '\0';
    if (raised) {
        csp_describe_place(csp, text, sizeof text);
    }
    put_text(csp, noted ? csp->fault.place : text);
}

#if CSP_MEASURE

/* The longest step and the number of steps of each process that ran. A step is what runs from one choice of the scheduler to the
 * next; if a process calls another, it counts for both. */
typedef struct measured {
    int64_t longest;
    int64_t steps;
} measured;

enum { DEEPEST = 64 };

static measured *measurements;
static uint32_t measured_processes;
static uint32_t running[DEEPEST];
static uint32_t running_count;
static int64_t began;

void csp_measure_begin(csp_kernel *csp)
{
    (void)csp;
    running_count = 0;
    reporting = 0;
    began = time_used();
}

void csp_measure_party(csp_kernel *csp, uint32_t number)
{
    (void)csp;
    if (running_count < (uint32_t)DEEPEST) {
        running[running_count] = number;
        running_count++;
    }
}

static void make_room(uint32_t number)
{
    if (number >= measured_processes) {
        const uint32_t more = (number + 1U) * 2U;
        measured *const grown = realloc(measurements, more * sizeof *measurements);
        if (grown == NULL) {
            (void)fputs("no memory for execution times\n", stderr);
            exit(EXIT_FAILURE);
        }
        (void)memset(&grown[measured_processes], 0, (more - measured_processes) * sizeof *grown);
        measurements = grown;
        measured_processes = more;
    }
}

void csp_measure_end(csp_kernel *csp)
{
    (void)csp;
    const int64_t took = time_used() - began - reporting;
    for (uint32_t index = 0; index < running_count; index++) {
        make_room(running[index]);
        measured *const entry = &measurements[running[index]];
        entry->steps++;
        if (took > entry->longest) {
            entry->longest = took;
        }
    }
}

static void report_execution_times(csp_kernel *csp)
{
    for (uint32_t number = 1; number < measured_processes; number++) {
        if (measurements[number].steps > 0) {
            csp_row *const added = begin_record(csp, EXECUTION_TIME, number);
            added->time = measurements[number].longest;
            added->value = (uint64_t)measurements[number].steps;
            completes();
        }
    }
}

#endif

bool csp_stream_end(csp_kernel *csp, csp_ending ending, double duration)
{
#if CSP_MEASURE
    report_execution_times(csp);
#endif
    if (ending == CSP_DEADLOCK) {
        csp_report_waiting(csp, report_waiting_process, NULL);
    }
    report_misses(csp, 0U);
    (void)memcpy(&begin_record(csp, END_OF_RUN, (uint32_t)ending)->value, &duration, sizeof duration);
    put_failure(csp, ending == CSP_FAILED);
    completes();
    flush(csp);
    return !csp_rows_lost();
}
