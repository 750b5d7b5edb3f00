/* See csp_signals.h. */
#define _XOPEN_SOURCE 700 /* POSIX, and a stack for handlers */

#include "csp_signals.h"

#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

enum { STACK = 65536, SIGNALLED = 128, PARENT_LOOKED_AT = 1 /* s */ };

static const int stopping[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE};
static const int crashing[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

enum { STOPPING = sizeof stopping / sizeof stopping[0], CRASHING = sizeof crashing / sizeof crashing[0] };

static struct sigaction stopping_before[STOPPING];
static struct sigaction crashing_before[CRASHING];
static stack_t stack_before;
static char stack[STACK]; /* a crash may be that of the stack */

static uint32_t begun; /* so many times */
static bool at_exit;
static pthread_t owner;
static volatile sig_atomic_t first; /* the signal that stopped the run; 0: none */
static volatile sig_atomic_t watched_parent;

enum { LOOKS = 10 /* a second */, LOOK = 1000000000 / LOOKS, WATCH_STACK = 1 << 17 };

static pthread_t watcher;
static bool watches;
static volatile uint32_t turns;
static volatile bool hangs;

static void handle(int number, void (*handler)(int), int flags, struct sigaction *before)
{
    struct sigaction action;
    action.sa_handler = handler;
    action.sa_flags = flags;
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(number, &action, before);
}

static void time_is_over(int number);

/* Only now: until then SIGALRM is the program's own. What hangs in the handler is interrupted by the same again. */
static void set_alarm(unsigned seconds)
{
    handle(SIGALRM, time_is_over, SA_RESTART | SA_NODEFER, NULL);
    (void)alarm(seconds);
}

/* A signal comes to any thread: the one that runs the program is not to go on meanwhile. */
static bool belongs_to_another(int number)
{
    if (pthread_equal(pthread_self(), owner) != 0) {
        return false;
    }
    (void)pthread_kill(owner, number);
    return true;
}

static void ask_to_stop(int number)
{
    if (first == 0) {
        first = number;
        set_alarm(CSP_GRACE);
    } else if (!csp_is_driving()) {
        _exit(SIGNALLED + number); /* the outputs are released, and what is left to be told is not wanted */
    } else {
        /* It has been asked. */
    }
    csp_request_stop();
}

static void stop(int number)
{
    const int error = errno;
    if (!belongs_to_another(number)) {
        ask_to_stop(number);
    }
    errno = error;
}

/* The time that the run had for stopping is over; or the parent is to be looked at. */
static void time_is_over(int number)
{
    const int error = errno;
    if (belongs_to_another(number)) {
        errno = error;
    } else if ((first != 0) || hangs) {
        if (csp_is_driving()) {
            set_alarm(CSP_GRACE);
            csp_release_outputs();
            _exit((first != 0) ? (SIGNALLED + first) : EXIT_FAILURE);
        }
        errno = error;
    } else if ((watched_parent != 0) && (getppid() != (pid_t)watched_parent)) {
        ask_to_stop(SIGTERM);
        errno = error;
    } else {
        set_alarm(PARENT_LOOKED_AT);
        errno = error;
    }
}

static void crash(int number)
{
    first = number;
    set_alarm(CSP_GRACE);
    csp_release_outputs();
    handle(number, SIG_DFL, 0, NULL);
    (void)raise(number);
}

static void *watch(void *nothing)
{
    static const char account[] = "a step or a device function has not come back: the outputs are released\n";
    const struct timespec look = {0, LOOK};
    uint32_t seen = turns;
    uint32_t looks = 0U;
    while (looks < (CSP_PATIENCE * (uint32_t)LOOKS)) {
        (void)nanosleep(&look, NULL);
        looks = (turns == seen) ? (looks + 1U) : 0U;
        seen = turns;
    }
    const ssize_t written = write(STDERR_FILENO, account, sizeof account - 1U);
    (void)written;
    hangs = true;
    handle(SIGALRM, time_is_over, SA_RESTART | SA_NODEFER, NULL);
    (void)pthread_kill(owner, SIGALRM);
    return nothing;
}

void csp_signals_watch(int priority)
{
    struct sched_param parameter;
    pthread_attr_t attributes;
    sigset_t all;
    sigset_t before;
    hangs = false;
    if (watches || (pthread_attr_init(&attributes) != 0)) {
        return;
    }
    (void)pthread_attr_setstacksize(&attributes, WATCH_STACK);
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_BLOCK, &all, &before); /* which the thread inherits */
    watches = pthread_create(&watcher, &attributes, watch, NULL) == 0;
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    (void)pthread_attr_destroy(&attributes);
    parameter.sched_priority = priority;
    if (watches) {
        (void)pthread_setschedparam(watcher, SCHED_FIFO, &parameter); /* where that is allowed */
    }
}

void csp_signals_turn(void)
{
    turns++;
}

static void end_watch(void)
{
    if (watches) {
        watches = false;
        (void)pthread_cancel(watcher);
        (void)pthread_join(watcher, NULL);
    }
}

void csp_signals_begin(void)
{
    stack_t alternate;
    begun++;
    if (begun > 1U) {
        return;
    }
    owner = pthread_self();
    first = 0;
    if (!at_exit) {
        at_exit = atexit(csp_release_outputs) == 0;
    }
    alternate.ss_sp = stack;
    alternate.ss_size = sizeof stack;
    alternate.ss_flags = 0;
    (void)sigaltstack(&alternate, &stack_before);
    for (uint32_t index = 0U; index < (uint32_t)CRASHING; index++) {
        handle(crashing[index], crash, SA_ONSTACK | SA_NODEFER, &crashing_before[index]);
    }
    for (uint32_t index = 0U; index < (uint32_t)STOPPING; index++) {
        handle(stopping[index], stop, SA_RESTART, /* of writes: waits end */
               &stopping_before[index]);
        if ((stopping[index] == SIGHUP) && (stopping_before[index].sa_handler == SIG_IGN)) {
            (void)sigaction(SIGHUP, &stopping_before[index], NULL);
        }
    }
}

void csp_signals_end(void)
{
    end_watch();
    if (begun != 1U) {
        begun -= (begun > 0U) ? 1U : 0U;
        return;
    }
    begun = 0U;
    if (first != 0) {
        (void)alarm(0U);
    }
    for (uint32_t index = 0U; index < (uint32_t)STOPPING; index++) {
        (void)sigaction(stopping[index], &stopping_before[index], NULL);
    }
    for (uint32_t index = 0U; index < (uint32_t)CRASHING; index++) {
        (void)sigaction(crashing[index], &crashing_before[index], NULL);
    }
    (void)sigaltstack(&stack_before, NULL);
}

void csp_signals_end_with_parent(long parent)
{
    watched_parent = (sig_atomic_t)parent;
    set_alarm(PARENT_LOOKED_AT);
}

int csp_exit_status(csp_ending ending)
{
    if ((ending == CSP_TERMINATED) || (ending == CSP_TIME_LIMIT)) {
        return EXIT_SUCCESS;
    }
    return ((ending == CSP_STOPPED) && (first != 0)) ? (SIGNALLED + first) : EXIT_FAILURE;
}
