/* The port for real time on POSIX systems: the monotonic clock, absolute waits, and where the system allows it, memory that stays and a
 * scheduling class that ordinary programs cannot interrupt. It tells at the end how late instants were met. */
#define _POSIX_C_SOURCE 200809L

#include "csp_port.h"

#include <inttypes.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>

#include "csp_program.h"

#define NANOSECONDS INT64_C(1000000000)

/* So long a signal that comes just before a wait can stay unnoticed. */
#define LONGEST_WAIT (NANOSECONDS / 20)

/* Priority among real-time programs: above most, below the threads of the system. */
enum { PRIORITY = 60 };

/* Upper ends of the classes of lateness in nanoseconds, each twice the one before; the last class has no end. */
enum { CLASSES = 14, FIRST_END = 2000 };

const bool csp_port_virtual_time = false;

static int64_t started;
static bool locked;
static bool preferred;
static sigset_t mask_outside; /* critical sections */

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

static void stop(int number)
{
    (void)number;
    csp_request_stop();
}

void csp_port_start(void)
{
    struct sched_param parameter;
    struct sigaction action;
    parameter.sched_priority = PRIORITY;
    action.sa_handler = stop;
    action.sa_flags = SA_RESTART; /* of writes only: waits end at a signal */
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(SIGINT, &action, NULL);
    (void)sigaction(SIGTERM, &action, NULL);
    locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
    preferred = sched_setscheduler(0, SCHED_FIFO, &parameter) == 0;
    started = clock_now();
}

int64_t csp_port_now(void)
{
    return clock_now() - started;
}

void csp_port_wait_until(int64_t instant)
{
    const int64_t longest = csp_port_now() + LONGEST_WAIT;
    const int64_t until = started + ((instant < longest) ? instant : longest);
    struct timespec when;
    when.tv_sec = (time_t)(until / NANOSECONDS);
    when.tv_nsec = (long)(until % NANOSECONDS);
    (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, NULL);
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

void csp_port_finish(void)
{
    int64_t end = FIRST_END;
    if (instants == 0U) {
        return;
    }
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

/* Handlers of signals are the interrupt handlers here. */
void csp_port_enter_critical(void)
{
    sigset_t all;
    (void)sigfillset(&all);
    (void)sigprocmask(SIG_BLOCK, &all, &mask_outside);
}

void csp_port_leave_critical(void)
{
    (void)sigprocmask(SIG_SETMASK, &mask_outside, NULL);
}

void csp_port_fatal(const char *message)
{
    (void)fprintf(stderr, "%s\n", message);
    exit(EXIT_FAILURE);
}
