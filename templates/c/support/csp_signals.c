/* SPDX-License-Identifier: 0BSD */
/* See csp_signals.h. */
#define _DEFAULT_SOURCE /* anonymous memory */
#define _XOPEN_SOURCE 700 /* POSIX, and a stack for handlers */

#include "csp_signals.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/mman.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <time.h>
#include <unistd.h>

#include "csp_internal.h"
#include "csp_shared.h"
#include "csp_text.h"
#include "csp_watch.h"

enum { STACK = 65536, SIGNALS = 128 /* more than exist */, TEXT = 512 };

/* Signals that do not end a process, or that cannot be handled. */
static const int harmless[] = {SIGCHLD, SIGCONT, SIGURG, SIGTSTP, SIGTTIN, SIGTTOU, SIGSTOP, SIGKILL,
#ifdef SIGWINCH
                               SIGWINCH,
#endif
};
static const int crashes[] = {CSP_CRASHES};

static bool has_handler[SIGNALS]; /* which signals have a handler of this file */
static sigset_t held_before;
static stack_t stack_before;

static volatile uint32_t begun; /* the depth of nested csp_signals_begin */
static pthread_t owner;         /* the thread of the run */
static pthread_key_t end_of_owner;
static volatile uint32_t first; /* the signal that stopped the run; 0: none */
static struct timespec stop_requested_at;
static volatile bool leaving; /* another thread will end the process when the outputs are released */

static bool contains(const int *numbers, size_t count, int number)
{
    bool found = false;
    for (size_t index = 0U; (index < count) && !found; index++) {
        found = numbers[index] == number;
    }
    return found;
}

void csp_signals_handle(int number, void (*handler)(int), int flags)
{
    struct sigaction action;
    action.sa_handler = handler;
    action.sa_flags = flags;
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(number, &action, NULL);
}

static bool has_default(int number)
{
    struct sigaction present;
    return (sigaction(number, NULL, &present) == 0) && ((present.sa_flags & SA_SIGINFO) == 0) &&
           (present.sa_handler == SIG_DFL);
}

static bool in_owner(void)
{
    return pthread_equal(pthread_self(), owner) != 0;
}

void csp_signals_wait_for_the_end(void)
{
    for (;;) {
        (void)pause();
    }
}

/* ---- Requests to stop ---- */

uint32_t csp_signals_first(void)
{
    return CSP_LOAD(first);
}

bool csp_signals_leaving(void)
{
    return CSP_LOAD(leaving);
}

/* Whether the first request is long enough ago that everything should have been reported. */
static bool is_request_old(void)
{
    struct timespec present = {0, 0};
    (void)clock_gettime(CLOCK_MONOTONIC, &present);
    return (present.tv_sec - stop_requested_at.tv_sec) > (time_t)CSP_GRACE;
}

void csp_signals_ask_to_stop(int number)
{
    if (CSP_LOAD(first) == 0U) {
        (void)clock_gettime(CLOCK_MONOTONIC, &stop_requested_at);
        CSP_STORE(first, (uint32_t)number);
    } else if (!csp_is_driving(csp_owned()) && is_request_old()) {
        _exit((int)CSP_SIGNALLED + (int)CSP_LOAD(first));
    } else {
        /* The run has already been requested to stop. */
    }
    csp_request_stop(csp_owned());
}

static void stop(int number)
{
    const int error = errno;
    csp_signals_ask_to_stop(number);
    errno = error;
}

/* ---- Releases ---- */

/* A thread other than that of the run waits until the run has stopped and released the outputs; the watcher limits how long that takes. */
static void release(void)
{
    if (!csp_is_driving(csp_owned())) {
        return;
    }
    if (!in_owner()) {
        CSP_STORE(leaving, true);
        csp_request_stop(csp_owned());
        for (uint32_t checks = 0U; csp_is_driving(csp_owned()) && (csp_watch_runs() || (checks < (CSP_GRACE * (uint32_t)CSP_CHECKS))); checks++) {
            csp_watch_wait_for_check();
        }
    }
    csp_release_outputs(csp_owned());
}

/* Says what ends the process, and where. Where memory is damaged this may crash, too: the next handler continues with the release. */
static void say_what_ends(const char *what)
{
    static volatile bool said;
    char where[TEXT] = "another thread";
    char line[TEXT + 64] = "";
    if (said || !csp_is_driving(csp_owned())) {
        return;
    }
    said = true;
    if (in_owner()) {
        csp_describe_interrupted(csp_owned(), where, sizeof where);
    }
    csp_append(line, sizeof line, what);
    csp_append(line, sizeof line, (where[0] == '\0') ? "" : " in ");
    csp_append(line, sizeof line, where);
    csp_append(line, sizeof line, ": the outputs are released\n");
    csp_watch_say(line);
}

/* Registered again before the release, for the case that a device function calls exit: each exit removes a function from the list and continues after it. */
static void at_exit(void)
{
    if (csp_is_driving(csp_owned())) {
        (void)atexit(at_exit);
        say_what_ends("exit was called");
        release();
        csp_watch_attend(true);
    }
}

static void crash(int number)
{
    if (CSP_LOAD(first) == 0U) {
        CSP_STORE(first, (uint32_t)number);
    }
    say_what_ends("a crash");
    release();
    csp_watch_attend(true);
    csp_signals_handle(number, SIG_DFL, 0);
    (void)raise(number);
}

void csp_signals_end_with(int pipe)
{
    csp_signals_handle(SIGTERM, stop, SA_RESTART);
    has_handler[SIGTERM] = true;
    csp_watch_lifeline(pipe);
#ifdef __linux__
    (void)prctl(PR_SET_PDEATHSIG, SIGCONT); /* one that is stopped would not see the end of the pipe */
#endif
}

/* ---- Around a run ---- */

static void give_back_signals(void)
{
    struct sigaction present;
    for (int number = 1; number < (int)SIGNALS; number++) {
        if (has_handler[number] && (sigaction(number, NULL, &present) == 0) &&
            ((present.sa_handler == stop) || (present.sa_handler == crash))) {
            csp_signals_handle(number, SIG_DFL, 0);
        }
        has_handler[number] = false;
    }
}

static void take_signals(void)
{
    for (int number = 1; (number < (int)SIGNALS) && (number <= SIGRTMAX); number++) {
        if (!has_default(number) || contains(harmless, sizeof harmless / sizeof harmless[0], number)) {
            continue;
        }
        has_handler[number] = true;
        if (contains(crashes, sizeof crashes / sizeof crashes[0], number)) {
            csp_signals_handle(number, crash, SA_ONSTACK | SA_NODEFER);
        } else {
            csp_signals_handle(number, stop, SA_RESTART); /* restarts writes; waits end */
        }
    }
}

/* Provides a stack for signal handlers, because a crash may be an overflow of the stack. A device function may overflow this stack, too: the page below
 * it is protected, and outside of it the next handler begins at its top again. */
static void take_stack(void)
{
    static char *memory;
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    stack_t alternate;
    if (memory == NULL) {
        void *const mapped = mmap(NULL, (2U * page) + STACK, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (mapped == MAP_FAILED) {
            return;
        }
        memory = (char *)mapped;
        (void)mprotect(memory, page, PROT_NONE);
    }
    alternate.ss_sp = memory + (2U * page);
    alternate.ss_size = STACK;
    alternate.ss_flags = 0;
    (void)sigaltstack(&alternate, &stack_before);
}

/* Unblocks the signals that are needed here: a crash whose signal is blocked would end the process immediately. */
static void let_through(void)
{
    sigset_t needed;
    (void)sigemptyset(&needed);
    (void)sigaddset(&needed, SIGURG);
    for (size_t index = 0U; index < (sizeof crashes / sizeof crashes[0]); index++) {
        (void)sigaddset(&needed, crashes[index]);
    }
    (void)pthread_sigmask(SIG_UNBLOCK, &needed, &held_before);
}

static void in_child(void)
{
    if (begun > 0U) {
        csp_forget_outputs(csp_owned());
        give_back_signals();
        begun = 0U;
        csp_watch_forget();
    }
}

static void owner_ends(void *nothing)
{
    (void)nothing;
    csp_release_outputs(csp_owned());
    csp_watch_attend(true);
    begun = 1U;
    csp_signals_end();
}

static void begin_once(void)
{
    (void)atexit(at_exit);
    (void)pthread_atfork(NULL, NULL, in_child);
    (void)pthread_key_create(&end_of_owner, owner_ends);
}

void csp_signals_begin(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    begun++;
    if (begun > 1U) {
        return;
    }
    owner = pthread_self();
    CSP_STORE(first, 0U);
    (void)pthread_once(&once, begin_once);
    (void)pthread_setspecific(end_of_owner, &owner);
    take_stack();
    take_signals();
    let_through();
    csp_watch_begin(owner);
}

/* After a signal the program is going to end, so handlers stay: the default of a further signal would end it with another status. */
void csp_signals_end(void)
{
    if (begun != 1U) {
        begun -= (begun > 0U) ? 1U : 0U;
        return;
    }
    csp_watch_end();
    if (CSP_LOAD(leaving)) {
        csp_signals_wait_for_the_end();
    }
    begun = 0U;
    if (CSP_LOAD(first) == 0U) {
        give_back_signals();
    }
    (void)pthread_setspecific(end_of_owner, NULL);
    (void)pthread_sigmask(SIG_SETMASK, &held_before, NULL);
    (void)sigaltstack(&stack_before, NULL);
}

int csp_exit_status(csp_ending ending)
{
    if ((ending == CSP_TERMINATED) || (ending == CSP_TIME_LIMIT)) {
        return EXIT_SUCCESS;
    }
    return ((ending == CSP_STOPPED) && (CSP_LOAD(first) != 0U)) ? ((int)CSP_SIGNALLED + (int)CSP_LOAD(first)) : EXIT_FAILURE;
}
