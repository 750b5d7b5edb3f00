/* SPDX-License-Identifier: 0BSD */
/* The port for real time on POSIX systems: the monotonic clock, absolute waits, and, if the system permits it, locked memory and a
 * scheduling class that ordinary programs cannot preempt. At the end it reports how late instants were executed. */
#define _POSIX_C_SOURCE 200809L

#include "csp_port.h"

#include <fcntl.h>
#include <inttypes.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/select.h>
#include <time.h>
#include <unistd.h>

#include "csp_program.h"
#include "csp_shared.h"
#include "csp_signals.h"

#define NANOSECONDS INT64_C(1000000000)

/* The interval at which csp_port_alive is called in idle times. */
#define LONGEST_WAIT (NANOSECONDS / 20)

/* The priority among real-time programs: above most of them, below the threads of the system. */
enum { PRIORITY = 60 };

/* The upper bounds of the classes of lateness in nanoseconds, each twice the previous one; the last class has none. */
enum { CLASSES = 14, FIRST_END = 2000 };

enum { MISSED = 2048 }; /* characters */

const bool csp_port_virtual_time = false;

static int64_t started;
static bool locked;
static bool preferred;

/* A pipe: csp_port_wake writes to one end, and csp_port_wait_until waits at the other. */
static int wakes[2] = {-1, -1};

/* Events may come from signal handlers and from other threads. */
static pthread_mutex_t critical = PTHREAD_MUTEX_INITIALIZER;
static __thread uint32_t depth;         /* of critical sections */
static __thread sigset_t signals_outside; /* the outermost */

static uint64_t instants;
static uint64_t in_class[CLASSES];
static int64_t latest;
static int64_t total;

static int64_t clock_now(void)
{
    struct timespec present = {0, 0};
    (void)clock_gettime(CLOCK_MONOTONIC, &present);
    return ((int64_t)present.tv_sec * NANOSECONDS) + (int64_t)present.tv_nsec;
}

/* The pipe is opened once and never closed: a thread that is about to write to it would write to another file instead. */
static void open_wakes(void)
{
    int ends[2] = {-1, -1};
    if ((CSP_LOAD(wakes[1]) >= 0) || (pipe(ends) != 0)) {
        return;
    }
    for (uint32_t end = 0U; end < 2U; end++) {
        (void)fcntl(ends[end], F_SETFL, O_NONBLOCK);
        (void)fcntl(ends[end], F_SETFD, FD_CLOEXEC);
        CSP_STORE(wakes[end], ends[end]);
    }
}

void csp_port_start(void)
{
    struct sched_param parameter;
    parameter.sched_priority = PRIORITY;
    csp_signals_begin();
    open_wakes();
    instants = 0U;
    (void)memset(in_class, 0, sizeof in_class);
    latest = 0;
    total = 0;
    locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
    preferred = sched_setscheduler(0, SCHED_FIFO, &parameter) == 0;
    csp_signals_watch(PRIORITY + 1);
    started = clock_now();
}

int64_t csp_port_now(void)
{
    return clock_now() - started;
}

void csp_port_wait_until(int64_t instant)
{
    const int64_t present = csp_port_now();
    const int64_t longest = present + LONGEST_WAIT;
    const int64_t rest = ((instant < longest) ? instant : longest) - present;
    struct timespec time_left = {0, 0};
    fd_set waited;
    int count = 0;
    FD_ZERO(&waited);
    if ((wakes[0] >= 0) && (wakes[0] < FD_SETSIZE)) {
        FD_SET(wakes[0], &waited);
        count = wakes[0] + 1;
    }
    if (rest > 0) {
        time_left.tv_nsec = (long)rest;
    }
    if (pselect(count, &waited, NULL, NULL, &time_left, NULL) > 0) {
        char taken[64];
        while (read(wakes[0], taken, sizeof taken) > 0) {
            /* One check is enough for all requests so far. */
        }
    }
}

/* May be called by signal handlers: it does not wait, and a full pipe wakes the run anyway. */
void csp_port_wake(void)
{
    const char wake = 1;
    const int end = CSP_LOAD(wakes[1]);
    if (end >= 0) {
        const ssize_t written = write(end, &wake, sizeof wake);
        (void)written;
    }
}

__attribute__((weak)) void csp_port_alive(void)
{
}

void csp_port_met(int64_t instant)
{
    const int64_t late = csp_port_now() - instant;
    int64_t end = FIRST_END;
    uint32_t class_number = 0U;
    while ((class_number < (CLASSES - 1U)) && (late >= end)) {
        end *= 2;
        class_number++;
    }
    in_class[class_number]++;
    instants++;
    total += late;
    if (late > latest) {
        latest = late;
    }
}

static void show_lateness(void)
{
    int64_t end = FIRST_END;
    (void)fprintf(stderr, "%" PRIu64 " instants, late by %.1f us on average, %.1f us at most (%s, %s)\n", instants,
                  (double)total / (double)instants / 1e3, (double)latest / 1e3,
                  preferred ? "SCHED_FIFO" : "ordinary scheduling: not allowed SCHED_FIFO",
                  locked ? "memory locked" : "memory not locked");
    for (uint32_t index = 0U; index < (uint32_t)CLASSES; index++) {
        if (in_class[index] > 0U) {
            const bool last = index == (CLASSES - 1U);
            (void)fprintf(stderr, "  %s %8.0f us  %10" PRIu64 "  %6.2f %%\n", last ? ">=" : "< ",
                          (double)(last ? (end / 2) : end) / 1e3, in_class[index],
                          100.0 * (double)in_class[index] / (double)instants);
        }
        end *= 2;
    }
}

void csp_port_finish(struct csp_kernel *csp)
{
    if (instants > 0U) {
        show_lateness();
        if (!csp->program->reports_misses) {
            char text[MISSED] = "";
            csp_describe_missed(csp, text, sizeof text);
            (void)fprintf(stderr, "  missed samples: %s\n", text);
        }
    }
    csp_signals_end();
}

/* Signal handlers and other threads take the place of interrupt handlers here. */
uint32_t csp_port_enter_critical(void)
{
    static const int never_held[] = {CSP_CRASHES};
    sigset_t held;
    sigset_t before;
    (void)sigfillset(&held);
    for (uint32_t index = 0U; index < (uint32_t)(sizeof never_held / sizeof never_held[0]); index++) {
        (void)sigdelset(&held, never_held[index]);
    }
    (void)pthread_sigmask(SIG_BLOCK, &held, &before);
    if (depth == 0U) {
        signals_outside = before;
        (void)pthread_mutex_lock(&critical);
    }
    depth++;
    return depth - 1U;
}

void csp_port_leave_critical(uint32_t outside)
{
    depth = outside;
    if (outside == 0U) {
        const sigset_t mask = signals_outside;
        (void)pthread_mutex_unlock(&critical);
        (void)pthread_sigmask(SIG_SETMASK, &mask, NULL);
    }
}

void csp_port_fatal(const char *message)
{
    (void)fprintf(stderr, "%s\n", message);
    exit(EXIT_FAILURE);
}
