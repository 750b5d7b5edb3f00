/* SPDX-License-Identifier: 0BSD
 *
 * The tank of ../superloop/tank.csp against the clock of a POSIX system: absolute sleeps, the scheduling class of
 * real-time programs, and no page faults once it runs. An argument is the number of milliseconds after which
 * somebody presses the button.
 */
#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>

#include "tank_api.h"

#define SECOND INT64_C(1000000000)

enum {
    STEPS = 64,             /* of processes between two looks at the clock */
    PRIORITY = 60,          /* above most real-time programs, below the threads of the system */
    STACK = 128 * 1024,     /* bytes that the loop may use at most */
    LONGEST = 10 * 1000000  /* ns of sleep: an event has no `wake` here, and a program may wait for nothing but events */
};

/* ---- The plant, where a machine has its drivers ---- */

static double level = 0.2;
static double opening;

static bool sample(void *context, tank_input input, tank_inputs *inputs)
{
    (void)context;
    (void)input; /* there is only one */
    level += (opening - (0.3 * level)) * 0.01;
    inputs->level = level;
    return true;
}

static void actuate(void *context, tank_output output, const tank_outputs *outputs, bool safe)
{
    (void)context;
    if (output == TANK_OUT_OPENING) {
        opening = outputs->opening;
    } else {
        (void)printf("lamp %s\n", outputs->lamp ? "on" : "off");
    }
    if (safe) {
        (void)printf("output %d is safe\n", (int)output);
    }
}

/* ---- A recorder of the last communications, which are shown if the run fails ---- */

enum { RECORDED = 8 };

typedef struct record {
    int64_t instant;
    uint32_t port; /* the tank has no channels inside */
    double value;
} record;

static record recorded[RECORDED];
static unsigned count_of_recorded;

static void trace(void *context, const tank_communication *communication)
{
    record *const next = &recorded[count_of_recorded % RECORDED];
    bool truth = false;
    (void)context;
    next->instant = communication->instant;
    next->port = communication->channel;
    if ((next->port == TANK_PORT_LEVEL) || (next->port == TANK_PORT_OPENING)) {
        (void)memcpy(&next->value, communication->value, sizeof next->value);
    } else {
        (void)memcpy(&truth, communication->value, sizeof truth);
        next->value = truth ? 1.0 : 0.0;
    }
    count_of_recorded++;
}

static void fault(void *context, const tank_instance *self)
{
    const unsigned first = (count_of_recorded > RECORDED) ? (count_of_recorded - RECORDED) : 0U;
    tank_failure failure;
    (void)context;
    if (tank_diagnose(self, &failure) && (failure.place != NULL)) {
        (void)fprintf(stderr, "failed at %s\n", failure.place);
    }
    for (unsigned index = first; index < count_of_recorded; index++) {
        const record *const one = &recorded[index % RECORDED];
        (void)fprintf(stderr, "%.3f s %s %g\n", (double)one->instant / 1e9, tank_channel_name(one->port), one->value);
    }
}

/* ---- Events come from other threads ---- */

static pthread_mutex_t events;

static uint32_t lock(void *context)
{
    (void)context;
    (void)pthread_mutex_lock(&events);
    return 0U;
}

static void unlock(void *context, uint32_t before)
{
    (void)context;
    (void)before; /* the mutex counts how often it is locked */
    (void)pthread_mutex_unlock(&events);
}

static bool begin_events(void)
{
    pthread_mutexattr_t kind;
    return (pthread_mutexattr_init(&kind) == 0)
        && (pthread_mutexattr_settype(&kind, PTHREAD_MUTEX_RECURSIVE) == 0)
        /* A thread that holds it runs with the priority of the loop while the loop waits for it. */
        && (pthread_mutexattr_setprotocol(&kind, PTHREAD_PRIO_INHERIT) == 0)
        && (pthread_mutex_init(&events, &kind) == 0);
}

/* ---- Time ---- */

static int64_t now(void)
{
    struct timespec present = {0, 0};
    (void)clock_gettime(CLOCK_MONOTONIC, &present);
    return ((int64_t)present.tv_sec * SECOND) + (int64_t)present.tv_nsec;
}

/* Returns early if a signal comes; the loop sleeps again then. */
static void sleep_until(int64_t instant)
{
    const struct timespec when = {(time_t)(instant / SECOND), (long)(instant % SECOND)};
    (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, NULL);
}

/* ---- The rights of a real-time program ---- */

/* Touches the stack, so that its pages are there, and locked, before the first instant. */
static void prefault_stack(void)
{
    volatile unsigned char pages[STACK];
    for (size_t at = 0; at < sizeof pages; at += 1024U) {
        pages[at] = 0U;
    }
}

static void become_real_time(void)
{
    struct sched_param parameter;
    (void)memset(&parameter, 0, sizeof parameter);
    parameter.sched_priority = PRIORITY;
    if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
        (void)fprintf(stderr, "memory is not locked: %s\n", strerror(errno));
    }
    prefault_stack();
    if (sched_setscheduler(0, SCHED_FIFO, &parameter) != 0) {
        (void)fprintf(stderr, "ordinary scheduling: %s\n", strerror(errno));
    }
}

/* ---- The program ---- */

static tank_memory memory;
static tank_instance *tank;

/* SIGINT and SIGTERM end the run at once, with safe outputs. */
static void on_signal(int number)
{
    (void)number;
    tank_stop(tank);
}

static void *operate(void *delay)
{
    const long milliseconds = *(const long *)delay;
    const struct timespec rest = {milliseconds / 1000, (milliseconds % 1000) * 1000000};
    (void)nanosleep(&rest, NULL);
    (void)tank_button(tank, true); /* taken at the next tick, 10 ms later at most */
    return NULL;
}

int main(int count, char **arguments)
{
    static const tank_hooks hooks = {
        .real_time = true, .sample = sample, .actuate = actuate, .lock = lock, .unlock = unlock, .trace = trace, .fault = fault};
    static long delay = 2000;
    const struct sigaction stopping = {.sa_handler = on_signal};
    const char *reason = NULL;
    sigset_t signals;
    pthread_t operator;
    tank_state state = TANK_MORE;
    char text[200];
    if (count > 1) {
        delay = strtol(arguments[1], NULL, 10);
    }
    tank = begin_events() ? tank_begin(&memory, sizeof memory, &hooks, &reason) : NULL;
    if (tank == NULL) {
        (void)fprintf(stderr, "%s\n", (reason != NULL) ? reason : "no mutex");
        return EXIT_FAILURE;
    }
    (void)sigaction(SIGINT, &stopping, NULL);
    (void)sigaction(SIGTERM, &stopping, NULL);
    /* Signals come to this thread, which they wake; the other one inherits that they are blocked. */
    (void)sigemptyset(&signals);
    (void)sigaddset(&signals, SIGINT);
    (void)sigaddset(&signals, SIGTERM);
    (void)pthread_sigmask(SIG_BLOCK, &signals, NULL);
    if (pthread_create(&operator, NULL, operate, &delay) != 0) {
        tank_finish(tank);
        return EXIT_FAILURE;
    }
    (void)pthread_sigmask(SIG_UNBLOCK, &signals, NULL);
    become_real_time(); /* this thread only */
    const int64_t started = now();
    while (tank_continues(state)) {
        state = tank_advance(tank, now() - started, STEPS);
        if (state == TANK_MORE) {
            const int64_t latest = (now() - started) + LONGEST;
            const int64_t next = tank_next(tank);
            sleep_until(started + ((next < latest) ? next : latest));
        }
    }
    tank_describe(tank, text, sizeof text);
    (void)printf("%s\n", text);
    (void)pthread_cancel(operator); /* it may sleep for long */
    (void)pthread_join(operator, NULL);
    return (state == TANK_ENDED) ? EXIT_SUCCESS : EXIT_FAILURE;
}
