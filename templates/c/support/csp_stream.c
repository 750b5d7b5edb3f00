/* See csp_stream.h. */
#define _POSIX_C_SOURCE 200809L /* threads, signals, and a clock for the processor time of this program */

#include "csp_stream.h"

#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "csp_arithmetic.h"
#include "csp_internal.h"
#include "csp_shared.h"
#include "csp_signals.h"

enum { BUFFER = 1 << 17 /* more than the longest value */, TEXT = 2048, LONGEST_WAIT = 1000 /* milliseconds */ };

/* The thread of the run fills the buffer and may be stopped anywhere, for good. Other threads, and the one that releases outputs in its place, send only
 * whole records: `complete` bytes. Only the sender, which holds the lock, removes bytes from the front. */
static unsigned char buffer[BUFFER];
static size_t filled;
static volatile size_t complete;
static size_t sent;
static pthread_mutex_t sending = PTHREAD_MUTEX_INITIALIZER;
static bool silent;
static volatile bool lost; /* some records could not be written */

/* Stops the run, because its records cannot be written. */
static void give_up(void)
{
    const bool nobody_reads = errno == EPIPE;
    CSP_STORE(lost, true);
    csp_request_stop();
    if (nobody_reads) {
        (void)kill(getpid(), SIGPIPE); /* the writing thread may have blocked the signal */
    }
}

/* Writes some of the data. Returns whether to continue: some was written, or another attempt may succeed. */
static bool send_some(const unsigned char *data, size_t size, size_t *taken)
{
    const ssize_t written = CSP_LOAD(lost) ? 0 : write(STDOUT_FILENO, data, size);
    *taken += (written > 0) ? (size_t)written : 0U;
    if ((written < 0) && (errno != EINTR) && (errno != EAGAIN)) {
        give_up();
    }
    return !CSP_LOAD(lost);
}

/* Blocks signals between a write and its bookkeeping, because a handler that interrupts the run does not return. */
static void hold_back(sigset_t *before)
{
    static const int numbers[] = {SIGURG, CSP_CRASHES};
    sigset_t held;
    (void)sigemptyset(&held);
    for (size_t index = 0U; index < (sizeof numbers / sizeof numbers[0]); index++) {
        (void)sigaddset(&held, numbers[index]);
    }
    (void)pthread_sigmask(SIG_BLOCK, &held, before);
}

/* Sends all complete records, and moves an incomplete one to the front. */
static void send_complete(void)
{
    sigset_t before;
    hold_back(&before);
    (void)pthread_mutex_lock(&sending);
    while ((sent < complete) && send_some(&buffer[sent], complete - sent, &sent)) {
        /* A pipe accepts as much as it has room for. */
    }
    (void)memmove(buffer, &buffer[complete], filled - complete);
    filled -= complete;
    sent = 0U;
    CSP_STORE(complete, 0U);
    (void)pthread_mutex_unlock(&sending);
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
}

static bool has_room(int wait)
{
    struct pollfd output = {STDOUT_FILENO, POLLOUT, 0};
    return poll(&output, 1U, wait) > 0;
}

/* Called by another thread, or in place of the run, which may have been stopped while sending: does not wait, except for the last time. */
static void attend(bool last)
{
    if (pthread_mutex_trylock(&sending) != 0) {
        return;
    }
    const size_t end = CSP_LOAD(complete);
    bool continues = true;
    while (continues && (sent < end) && has_room(last ? (int)LONGEST_WAIT : 0)) {
        const size_t rest = end - sent; /* a pipe with room accepts a part of it without waiting */
        continues = send_some(&buffer[sent], (rest < (size_t)PIPE_BUF) ? rest : (size_t)PIPE_BUF, &sent);
    }
    (void)pthread_mutex_unlock(&sending);
}

#if CSP_MEASURE

static int64_t reporting; /* nanoseconds that were spent on writing records, which do not count as execution time */

static int64_t time_used(void)
{
    struct timespec present;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &present);
    return ((int64_t)present.tv_sec * INT64_C(1000000000)) + (int64_t)present.tv_nsec;
}

static void flush(void)
{
    const int64_t before = time_used();
    send_complete();
    reporting += time_used() - before;
}

#else

static void flush(void)
{
    send_complete();
}

#endif

static void completes(void)
{
    CSP_STORE_AFTER(complete, filled);
}

/* A record that is longer than the buffer is sent in pieces. */
static void put(const void *data, size_t size)
{
    const unsigned char *const bytes = (const unsigned char *)data;
    size_t done = 0U;
    if (silent) {
        return;
    }
    if (size > (size_t)BUFFER - filled) {
        flush();
        while (size - done > (size_t)BUFFER - filled) {
            const size_t piece = (size_t)BUFFER - filled;
            (void)memcpy(&buffer[filled], &bytes[done], piece);
            done += piece;
            filled += piece;
            completes();
            flush();
        }
    }
    (void)memcpy(&buffer[filled], &bytes[done], size - done);
    filled += size - done;
}

/* Begins a record where the last complete one ends, discarding an incomplete one. */
static void put_first(uint8_t kind)
{
    filled = complete;
    put(&kind, sizeof kind);
}

static void put_byte(uint8_t number)
{
    put(&number, sizeof number);
}

static void put_number(uint32_t number)
{
    put(&number, sizeof number);
}

static void put_short(uint16_t number)
{
    put(&number, sizeof number);
}

static void put_time(int64_t time)
{
    put(&time, sizeof time);
}

static void put_text(const char *text)
{
    const size_t length = (text != NULL) ? strlen(text) : 0U;
    put_short((uint16_t)length);
    put(text, length);
}

#if CSP_TRACE

static const csp_names *known;
static uint32_t observed_channels;
static uint32_t named_channels;

void csp_observe(uint32_t channel, const void *value, uint32_t writer, uint32_t reader)
{
    if (channel >= observed_channels) {
        return;
    }
    put_first(3);
    put_time(csp.now);
    put_number(channel);
    put_number(writer);
    put_number(reader);
    put(value, known->channel_sizes[channel]);
    completes();
}

static void report_value(uint8_t kind, uint32_t port, const void *value)
{
    if (port < observed_channels) {
        put_first(kind);
        put_time(csp.now);
        put_number(port);
        put(value, known->channel_sizes[port]);
        completes();
    }
}

void csp_observe_sample(uint32_t port, const void *value)
{
    report_value(12, port, value);
}

void csp_observe_release(uint32_t port, const void *value)
{
    report_value(6, port, value);
}

static void begins_or_ends(uint8_t kind, uint32_t number)
{
    put_first(kind);
    put_time(csp.now);
    put_number(number);
    completes();
}

void csp_observe_begin(uint32_t number)
{
    begins_or_ends(4, number);
}

void csp_observe_end(uint32_t number)
{
    begins_or_ends(5, number);
}

/* Writes the names of the channels before `end` that have not been named yet. */
static void name_channels(uint32_t end)
{
    for (; named_channels < end; named_channels++) {
        put_first(1);
        put_number(named_channels);
        put_short(known->channel_sizes[named_channels]);
        put_text(known->channel_names[named_channels]);
        completes();
    }
}

/* A waiting process may wait at any channel, observed or not. */
static void name_all_channels(void)
{
    name_channels(known->channel_count);
}

void csp_stream_begin(const csp_program *program, const csp_names *names, csp_observed observed)
{
    known = names;
    silent = observed == CSP_SILENT;
    csp_signals_attend(attend);
    observed_channels = (observed <= CSP_OBSERVE_NONE)    ? 0U
                        : (observed == CSP_OBSERVE_PORTS) ? program->port_count
                                                          : names->channel_count;
    named_channels = 0;
    name_channels((observed_channels > program->port_count) ? observed_channels : program->port_count);
    for (uint32_t number = 1; number <= names->process_count; number++) {
        put_first(2);
        put_number(number);
        put_text(names->process_names[number]);
        put_text(names->process_kinds[number]);
        completes();
    }
}

#else

void csp_stream_begin(const csp_program *program, const csp_names *names, csp_observed observed)
{
    (void)program;
    (void)names;
    silent = observed == CSP_SILENT;
    csp_signals_attend(attend);
}

static void name_all_channels(void)
{
    /* Without CSP_TRACE channels have no names. */
}

#endif

/* Whether the writer of a broadcast waits for this end: to take the value, or, with an output guard, to be read from. */
static bool is_missing(const csp_broadcast *channel, const csp_broadcast_end *end)
{
    return (channel->writer != NULL) ? end->fresh : ((end->reader == NULL) && (end->waiting == NULL));
}

/* For a process that waits to write to a broadcast channel: which of its ends are missing, numbered from 0 in the order in which they are served. */
static void report_missing(const csp_medium *medium)
{
    const csp_broadcast *const channel =
        (medium->kind == (uint8_t)CSP_BROADCAST) ? (const csp_broadcast *)(const void *)medium : NULL;
    const csp_broadcast_end *const ends = (channel != NULL) ? channel->ends : NULL;
    uint16_t count = 0;
    for (const csp_broadcast_end *end = ends; end != NULL; end = end->next) {
        count = (uint16_t)(count + (is_missing(channel, end) ? 1U : 0U));
    }
    put_short(count);
    uint16_t index = 0;
    for (const csp_broadcast_end *end = ends; end != NULL; end = end->next) {
        if (is_missing(channel, end)) {
            put_short(index);
        }
        index++;
    }
}

static void report_waiting_process(const csp_program *program, const csp_waiting_process *waiting)
{
    char text[TEXT] = "";
    csp_wait_entry entry;
    uint16_t channels = 0;
    name_all_channels();
    put_first(8);
    put_number(waiting->process->party.number);
    if (program->process_name != NULL) {
        program->process_name(waiting->process->party.number, text, sizeof text);
    }
    put_text(text);
    put_text(waiting->process->kind->where);
    put_text(waiting->place->where);
    csp_describe_waiting(program, waiting, text, sizeof text);
    put_text(text);
    for (uint32_t index = 0; csp_wait_of(waiting, index, &entry); index++) {
        channels = (uint16_t)(channels + (entry.named ? 1U : 0U));
    }
    put_short(channels);
    for (uint32_t index = 0; csp_wait_of(waiting, index, &entry); index++) {
        if (entry.named) {
            put_number(entry.channel);
            report_missing(entry.medium);
        }
    }
    completes();
}

/* Writes exception, message and place. A fault of the environment remains in `csp_fault`. */
static void put_failure(const csp_program *program, bool failed)
{
    char text[TEXT] = "";
    const bool raised = failed && (csp.error.exception != (uint16_t)CSP_NO_EXCEPTION);
    const bool noted = failed && !raised && csp_faulted();
    put_text(raised ? csp_exception_name(program) : "");
    if (raised) {
        csp_describe_message(program, text, sizeof text);
    } else if (noted) {
        csp_fault.describe(&csp_fault.operands, text, sizeof text);
    } else {
        /* There is nothing to report. */
    }
    put_text(text);
    text[0] = '\0';
    if (raised) {
        csp_describe_place(program, text, sizeof text);
    }
    put_text(noted ? csp_fault.place : text);
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

void csp_measure_begin(void)
{
    running_count = 0;
    reporting = 0;
    began = time_used();
}

void csp_measure_party(uint32_t number)
{
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

void csp_measure_end(void)
{
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

static void report_execution_times(void)
{
    for (uint32_t number = 1; number < measured_processes; number++) {
        if (measurements[number].steps > 0) {
            put_first(11);
            put_number(number);
            put_time(measurements[number].longest);
            put_time(measurements[number].steps);
            completes();
        }
    }
}

#endif

bool csp_stream_end(const csp_program *program, csp_ending ending, double duration)
{
#if CSP_MEASURE
    report_execution_times();
#endif
    if (ending == CSP_DEADLOCK) {
        csp_report_waiting(program, report_waiting_process);
    }
    for (uint32_t index = 0; index < program->port_count; index++) {
        if (program->ports[index].kind == CSP_PORT_SAMPLED) {
            const csp_medium *const medium = program->ports[index].medium;
            put_first(9);
            put_number(medium->number);
            put_number(((const csp_sampled_input *)(const void *)medium)->missed);
            completes();
        }
    }
    put_first(10);
    put_byte((uint8_t)ending);
    put_time(csp.now);
    put(&duration, sizeof duration);
    put_failure(program, ending == CSP_FAILED);
    completes();
    flush();
    return !lost;
}
