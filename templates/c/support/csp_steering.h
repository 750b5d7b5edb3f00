/* SPDX-License-Identifier: 0BSD */
/* A simulation that is steered: in virtual time it advances only by orders, and its inputs may be taken over from its environment.
 *
 * The orders come through a pipe, each followed by `size` bytes. Those to advance, and that for a report, are answered in the stream (csp_stream_held); all
 * others are carried out before the next of these. While it advances, only orders about inputs
 * and that to pause may come. The run ends when the other end of the pipe is closed.
 *
 * In real time the clock alone advances it. It reports in the stream that it has begun
 * (csp_stream_held) and, often enough for a picture, how far it is (csp_stream_present). Orders are
 * carried out when all processes wait. */
#ifndef CSP_STEERING_H
#define CSP_STEERING_H

#include "csp_program.h"

typedef enum csp_order_kind {
    CSP_ADVANCE,   /* up to and including the instant; the answer says whether it got there */
    CSP_STEP,      /* the same, but only until `number` values were communicated, and the step of a process is over in which that happened */
    CSP_PAUSE,     /* ends what it does, unless that has ended already; in real time it continues */
    CSP_TAKE,      /* the port `number`, an input, has the value that follows, whatever the environment computes */
    CSP_GIVE_BACK, /* the environment has it again, from the next instant on */
    CSP_REPORT     /* which processes wait for what, in records like those after a deadlock */
} csp_order_kind;

typedef struct csp_order {
    int64_t instant;
    uint32_t kind; /* csp_order_kind */
    uint32_t number;
    uint32_t size;
    uint32_t unused;
} csp_order;

/* The descriptor of the pipe; false: it is not a number. */
bool csp_steering_open(const char *text);

/* Whether there is one. */
bool csp_is_steered(void);

/* As csp_run. */
csp_ending csp_run_steered(csp_kernel *csp, int64_t until);

#endif
