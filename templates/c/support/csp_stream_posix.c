/* SPDX-License-Identifier: 0BSD */
/* Rows are written to standard output, also by another thread while the run computes. See csp_stream_rows.h. */
#define _POSIX_C_SOURCE 200809L /* threads and signals */

#include "csp_stream_rows.h"

#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "csp_shared.h"
#include "csp_signals.h"

enum { LONGEST_WAIT = 1000 /* milliseconds */ };

csp_unsent_rows csp_rows;

static int output = STDOUT_FILENO;

/* Only the sender, which holds the lock, removes rows from the front; `sent` counts bytes. */
static size_t sent;
static pthread_mutex_t sending = PTHREAD_MUTEX_INITIALIZER;
static volatile bool lost; /* some records could not be written */

/* Stops the run, because its records cannot be written. */
static void give_up(csp_kernel *csp)
{
    const bool nobody_reads = errno == EPIPE;
    CSP_STORE(lost, true);
    csp_request_stop(csp);
    if (nobody_reads) {
        (void)kill(getpid(), SIGPIPE); /* the writing thread may have blocked the signal */
    }
}

/* Writes at most `size` bytes of the rows that are not sent. Returns whether to continue: some were written, or another attempt may succeed. */
static bool send_some(csp_kernel *csp, size_t size)
{
    const ssize_t written = CSP_LOAD(lost) ? 0 : write(output, (const unsigned char *)csp_rows.of + sent, size);
    sent += (written > 0) ? (size_t)written : 0U;
    if ((written < 0) && (errno != EINTR) && (errno != EAGAIN)) {
        give_up(csp);
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

void csp_rows_send(csp_kernel *csp)
{
    sigset_t before;
    hold_back(&before);
    (void)pthread_mutex_lock(&sending);
    const size_t end = csp_rows.complete * sizeof(csp_row);
    while ((sent < end) && send_some(csp, end - sent)) {
        /* A pipe accepts as much as it has room for. */
    }
    (void)memmove(csp_rows.of, &csp_rows.of[csp_rows.complete], (csp_rows.filled - csp_rows.complete) * sizeof(csp_row));
    csp_rows.filled -= csp_rows.complete;
    sent = 0U;
    CSP_STORE(csp_rows.complete, 0U);
    (void)pthread_mutex_unlock(&sending);
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
}

static bool has_room(int wait)
{
    struct pollfd room = {output, POLLOUT, 0};
    return poll(&room, 1U, wait) > 0;
}

/* Called by another thread, or in place of the run, which may have been stopped while sending: does not wait, except for the last time. */
static void attend(bool last)
{
    if (pthread_mutex_trylock(&sending) != 0) {
        return;
    }
    const size_t end = CSP_LOAD(csp_rows.complete) * sizeof(csp_row);
    bool continues = true;
    while (continues && (sent < end) && has_room(last ? (int)LONGEST_WAIT : 0)) {
        const size_t rest = end - sent; /* a pipe with room accepts a part of it without waiting */
        continues = send_some(csp_owned(), (rest < (size_t)PIPE_BUF) ? rest : (size_t)PIPE_BUF);
    }
    (void)pthread_mutex_unlock(&sending);
}

/* What bodies in C print goes to standard error: it must not get among the rows. */
static void keep_output(void)
{
    const int kept = (output == STDOUT_FILENO) ? dup(STDOUT_FILENO) : -1;
    if (kept >= 0) {
        output = kept;
        (void)dup2(STDERR_FILENO, STDOUT_FILENO);
        (void)setvbuf(stdout, NULL, _IOLBF, 0U);
    }
}

void csp_rows_begin(void)
{
    keep_output();
    csp_signals_attend(attend);
}

bool csp_rows_lost(void)
{
    return lost;
}
