/* SPDX-License-Identifier: 0BSD */
/* See csp_watch.h. */
#define _XOPEN_SOURCE 700 /* POSIX */

#include "csp_watch.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "csp_internal.h"
#include "csp_shared.h"

enum { TEXT = 512, CHECK_INTERVAL = 1000000000 / CSP_CHECKS, THREAD_STACK = 1 << 17 };

static pthread_t owner; /* the thread of the run */
static pthread_t watcher;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER; /* of `over` */
static pthread_cond_t ended;
static bool over; /* the watcher is to end */
static volatile bool watched;
static volatile bool patient; /* whether a run without progress is taken to hang */
static volatile bool hangs;
static volatile bool forced;       /* the run is to be interrupted */
static volatile int lifeline = -1; /* the descriptor of a pipe at whose end the program ends; negative: none */
static volatile int listener = -1; /* the descriptor for a line about each check; negative: none */
static void (*volatile attendant)(bool last); /* NULL: none */

void csp_watch_wait_for_check(void)
{
    const struct timespec interval = {0, CHECK_INTERVAL};
    (void)nanosleep(&interval, NULL);
}

void csp_watch_say(const char *text)
{
    struct pollfd errors = {STDERR_FILENO, POLLOUT, 0};
    if ((poll(&errors, 1, 0) == 1) && (errors.revents == POLLOUT)) {
        const ssize_t written = write(STDERR_FILENO, text, strlen(text));
        (void)written;
    }
}

void csp_watch_attend(bool last)
{
    void (*const attend)(bool) = CSP_LOAD(attendant);
    if (attend != NULL) {
        attend(last);
    }
}

/* ---- Releases by force ---- */

static void end_by_force(void)
{
    if (csp_signals_leaving()) {
        csp_signals_wait_for_the_end();
    }
    csp_watch_attend(true);
    const uint32_t first = csp_signals_first();
    _exit((first != 0U) ? ((int)CSP_SIGNALLED + (int)first) : EXIT_FAILURE);
}

/* Runs in the thread of the run; a device function that hangs here is interrupted by the same signal again. */
static void let_go(int number)
{
    const int error = errno;
    (void)number;
    if (CSP_LOAD(forced) && (pthread_equal(pthread_self(), owner) != 0) && csp_is_driving(csp_owned())) {
        csp_release_outputs(csp_owned());
        end_by_force();
    }
    errno = error;
}

static void *release_instead(void *nothing)
{
    csp_release_outputs(csp_owned());
    end_by_force();
    return nothing;
}

/* The first attempt sends the signal; each further one gives up an output. A thread that blocks the signal is not waited for. */
static void force(bool in_vain)
{
    pthread_attr_t attributes;
    pthread_t helper;
    CSP_STORE(forced, true);
    if (!in_vain) {
        csp_signals_handle(SIGURG, let_go, SA_RESTART | SA_NODEFER);
        (void)pthread_kill(owner, SIGURG);
    } else if (pthread_attr_init(&attributes) == 0) {
        (void)pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
        (void)pthread_attr_setstacksize(&attributes, THREAD_STACK);
        (void)pthread_create(&helper, &attributes, release_instead, NULL);
        (void)pthread_attr_destroy(&attributes);
    } else {
        csp_release_outputs(csp_owned());
    }
}

/* ---- Reports ---- */

static void report_what_hangs(void)
{
    char text[TEXT] = "";
    char line[TEXT + 64] = "";
    csp_describe_present(csp_owned(), text, sizeof text);
    (void)snprintf(line, sizeof line, "%s for %u s: the outputs are released\n", text, (unsigned)CSP_PATIENCE);
    csp_watch_say(line);
}

/* A processor may store the two halves separately. Then they may belong to two instants, but are not the same wrong value twice. */
static int64_t instant_now(void)
{
    const volatile int64_t *const now = &csp_owned()->now;
    int64_t before = 0;
    int64_t found = *now;
    do {
        before = found;
        found = *now;
    } while (found != before);
    return found;
}

/* Writes a line with the instant, and with the running process if the instant has not changed since the last check. If the reader is not ready, the
 * line is lost. */
static void report_check(int64_t *reported)
{
    const int descriptor = CSP_LOAD(listener);
    char text[TEXT] = "";
    char line[TEXT + 64] = "";
    if ((descriptor < 0) || !csp_is_driving(csp_owned())) {
        return;
    }
    const int64_t now = instant_now();
    if (now == *reported) {
        csp_describe_at_work(csp_owned(), text, sizeof text);
    }
    *reported = now;
    const int length = snprintf(line, sizeof line, "%" PRId64 " %s\n", now, text);
    const ssize_t written = write(descriptor, line, (size_t)length);
    (void)written;
}

/* ---- The thread ---- */

/* Waits until the next check; false: there will be none. */
static bool wait_for_a_check(void)
{
    struct timespec next;
    (void)clock_gettime(CLOCK_MONOTONIC, &next);
    next.tv_nsec += CHECK_INTERVAL;
    if (next.tv_nsec >= 1000000000) {
        next.tv_nsec -= 1000000000;
        next.tv_sec++;
    }
    (void)pthread_mutex_lock(&lock);
    int waited = 0;
    while (!over && (waited == 0)) {
        waited = pthread_cond_timedwait(&ended, &lock, &next);
    }
    const bool continues = !over;
    (void)pthread_mutex_unlock(&lock);
    return continues;
}

/* Nothing is written to the pipe, so whatever happens to it is its end. */
static bool has_lost_its_lifeline(void)
{
    struct pollfd pipe = {CSP_LOAD(lifeline), POLLIN, 0};
    return poll(&pipe, 1, 0) > 0; /* a negative descriptor is left out */
}

static void *watch(void *nothing)
{
    uint32_t iterations = 0U;
    uint32_t released = 0U;
    uint32_t checks = 0U;
    int64_t reported = -1;
    bool in_vain = false;
    while (wait_for_a_check()) {
        report_check(&reported);
        csp_watch_attend(false);
        if (has_lost_its_lifeline()) {
            CSP_STORE(lifeline, -1);
            csp_signals_ask_to_stop(SIGTERM);
        }
        const bool must_end = (csp_signals_first() != 0U) || csp_signals_leaving() || CSP_LOAD(hangs);
        const uint32_t iterations_now = csp_iterations(csp_owned());
        const uint32_t released_now = csp_calls_now(csp_owned()).released;
        const bool progresses = (released_now != released) || (!must_end && (iterations_now != iterations));
        in_vain = in_vain && (released_now == released);
        iterations = iterations_now;
        released = released_now;
        checks = (progresses || !csp_is_driving(csp_owned()) || !(must_end || CSP_LOAD(patient))) ? 0U : (checks + 1U);
        if (checks >= ((must_end ? CSP_GRACE : CSP_PATIENCE) * (uint32_t)CSP_CHECKS)) {
            if (!must_end) {
                report_what_hangs();
                CSP_STORE(hangs, true);
            }
            force(in_vain);
            in_vain = true;
            checks = 0U;
        }
    }
    return nothing;
}

void csp_watch_begin(pthread_t run)
{
    pthread_attr_t attributes;
    pthread_condattr_t monotonic;
    sigset_t all;
    sigset_t before;
    owner = run;
    over = false;
    CSP_STORE(hangs, false);
    CSP_STORE(forced, false);
    CSP_STORE(patient, false);
    if ((pthread_condattr_init(&monotonic) != 0) || (pthread_attr_init(&attributes) != 0)) {
        return;
    }
    (void)pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&ended, &monotonic);
    (void)pthread_condattr_destroy(&monotonic);
    (void)pthread_attr_setstacksize(&attributes, THREAD_STACK);
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_BLOCK, &all, &before); /* the new thread inherits the mask */
    const bool created = pthread_create(&watcher, &attributes, watch, NULL) == 0;
    CSP_STORE(watched, created);
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    (void)pthread_attr_destroy(&attributes);
}

void csp_watch_end(void)
{
    if (CSP_LOAD(watched)) {
        CSP_STORE(watched, false);
        (void)pthread_mutex_lock(&lock);
        over = true;
        (void)pthread_cond_signal(&ended);
        (void)pthread_mutex_unlock(&lock);
        (void)pthread_join(watcher, NULL);
        (void)pthread_cond_destroy(&ended);
    }
}

void csp_watch_forget(void)
{
    CSP_STORE(watched, false);
}

bool csp_watch_runs(void)
{
    return CSP_LOAD(watched);
}

void csp_watch_lifeline(int descriptor)
{
    CSP_STORE(lifeline, descriptor);
}

void csp_signals_report(int descriptor)
{
    CSP_STORE(listener, descriptor);
}

void csp_signals_attend(void (*attend)(bool last))
{
    CSP_STORE(attendant, attend);
}

void csp_signals_watch(int priority)
{
    struct sched_param parameter;
    parameter.sched_priority = priority;
    if (CSP_LOAD(watched)) {
        (void)pthread_setschedparam(watcher, SCHED_FIFO, &parameter); /* if permitted */
    }
    CSP_STORE(patient, true);
}
