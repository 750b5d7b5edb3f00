/* SPDX-License-Identifier: 0BSD */
/* Processes: beginning, ending, failing, calling, running in parallel, waiting. */
#ifndef CSP_PROCESS_H
#define CSP_PROCESS_H

#include "csp_core.h"

/* Waits for an operation, in the step function of a process.
 *
 * A step function is a `switch (party->state)` that begins with `case 0:`. `first` begins the operation, and `again` continues it each time the process runs
 * again at PLACE; both are of type csp_progress, for which the function has a variable `progress`. If the operation fails, the process continues at the label
 * FAILED.
 *
 * This macro hides `return`, `case` and `goto`, and it is the only one: what it says at each wait is always the same eleven lines, which have to agree with
 * each other in three places. */
#define CSP_AWAIT(first, again, PLACE, FAILED)                                                                         \
    progress = (first);                                                                                                \
    while (progress == CSP_WAITS) {                                                                                    \
        party->state = (uint16_t)(PLACE);                                                                              \
        return NULL;                                                                                                   \
    case PLACE:                                                                                                        \
        progress = (again);                                                                                            \
    }                                                                                                                  \
    if (progress == CSP_FAILS) {                                                                                       \
        party->state = (uint16_t)(PLACE);                                                                              \
        goto FAILED;                                                                                                   \
    }

/* Whether the process was cancelled; then `csp->error` is set. To be called before communications of channels, and before those that never wait: outputs
 * to the outside, variables that are ports of control laws. */
static inline bool csp_refused(csp_kernel *csp, const csp_party *party)
{
    if (csp_is_cancelled(party)) {
        (void)csp_refuse(csp, party);
        return true;
    }
    return false;
}

/* The next free numbers, while a program is built. */
typedef struct csp_numbers {
    csp_kernel *csp;
    uint32_t process;
    uint32_t channel;
    uint32_t variable; /* of variables without an initial value that a process may read before they are written */
} csp_numbers;

typedef struct csp_written {
    bool done;
    uint32_t number; /* number of the variable */
} csp_written;

/* Notes a fault unless the variable was written; NULL: it always is. */
void csp_require_written(csp_kernel *csp, const csp_written *written);

/* The number of states in a table of places. */
#define CSP_STATES(places) ((uint16_t)(sizeof(places) / sizeof((places)[0])))

/* To be called before the program starts. */
void csp_process_init(csp_process *process, const csp_class *kind, uint32_t number);

/* Begins `callee` in sequence, in the task of `party`. Return the result to the scheduler; when `callee` has ended, the process continues at `party->state`,
 * or in the failed state of that place. */
csp_party *csp_call(csp_party *party, csp_process *callee);

/* End the process: normally, or with the failure in `csp->error`. Return the result to the scheduler. */
csp_party *csp_end(csp_kernel *csp, csp_party *party);
csp_party *csp_fail(csp_kernel *csp, csp_party *party);

/* For a state that the step function does not have, which only damaged memory contains: ends the run with a Fault that no process catches, for what it would
 * continue with may be damaged, too. Return the result to the scheduler. */
CSP_COLD csp_party *csp_overwritten(csp_kernel *csp, csp_party *party);

/* To be called first at a FAILED label, before ends are closed and exceptions caught: completes `csp->error`, also if the process was cancelled while it
 * waited. */
void csp_unwind(csp_kernel *csp, csp_party *party);

/* Raises an exception in the process; `place` is that of the statement; NULL: that of the present state. Always CSP_FAILS. */
CSP_COLD csp_progress csp_raise(csp_kernel *csp, csp_party *party, uint16_t exception, const char *place);
/* Raises the Fault that is noted in csp_fault (csp_arithmetic.h). Always CSP_FAILS. */
csp_progress csp_raise_fault(csp_kernel *csp, csp_party *party);

/* Catches `csp->error` if it is `exception`; returns whether it was. */
bool csp_catch(csp_kernel *csp, uint16_t exception);

/* ---- Delays ---- */

/* A node of the heap of instants. */
struct csp_timer {
    int64_t instant;
    uint64_t begun;    /* timers of one instant expire in the order in which they began */
    csp_timer *child;
    csp_timer *sibling;
    csp_timer *previous; /* the previous sibling, or for the first one the parent; NULL: the root, or not in the heap */
    csp_party *party;    /* the party that waits; NULL: see `guard` */
    csp_guard *guard;    /* the guard with this time-out, */
    int64_t duration;    /* and how long it is */
    bool runs;
};

csp_progress csp_wait(csp_kernel *csp, csp_party *party, csp_timer *timer, int64_t duration);
static inline csp_progress csp_wait_again(const csp_party *party)
{
    (void)party;
    return CSP_DONE;
}
/* Waits until the process is cancelled. */
csp_progress csp_stop(csp_kernel *csp, csp_party *party);

/* ---- Parallel ---- */

/* Branches at equal distances in the struct of the parent; offsets are from the beginning of the struct. */
typedef struct csp_branches {
    uint32_t offset; /* of the first csp_process */
    uint32_t stride; /* from one to the next, in bytes */
    uint32_t count;
    uint8_t level;   /* added to the level of the parent; 0 except for prioritized parallels */
    uint32_t parent_stride; /* from the first csp_process of one csp_numbered parent to that of the next */
} csp_branches;

typedef struct csp_parallel {
    uint32_t pending;
    uint32_t runs; /* number of csp_branches */
    csp_process *parent;
    struct csp_interrupt *interrupt; /* the interrupt whose body it is, or NULL */
    const csp_branches *branches;
    uint32_t run; /* position of a walk over the tree of processes */
    uint32_t index;
    bool abandoned; /* the parent was cancelled */
    bool cancelled; /* a branch was ended by cancellation */
    csp_error error; /* the first error of a branch */
} csp_parallel;

/* Starts all branches, in order. `party` waits for them with CSP_AWAIT(csp_par(...), csp_par_again(...), ...). */
csp_progress csp_par(csp_kernel *csp, csp_party *party, csp_parallel *parallel, const csp_branches *branches, uint32_t runs);
csp_progress csp_par_again(csp_kernel *csp, csp_party *party, csp_parallel *parallel);

/* The struct whose `member` (a csp_process) is at `party`; for step functions of branches. */
#define CSP_ENCLOSING(party, type, member) ((type *)(void *)((char *)(party) - offsetof(type, member)))

/* The same for a branch that is the csp_numbered `array[number]`. */
#define CSP_ENCLOSING_ARRAY(party, type, array, number)                                                                \
    ((type *)(void *)((char *)(party) - (offsetof(type, array) + ((size_t)(number) * sizeof(csp_numbered)))))
#define CSP_NUMBER(party) (((const csp_numbered *)(const void *)(party))->number)

/* The distance in bytes between elements of an array in a struct. */
#define CSP_STRIDE(type, array) (offsetof(type, array[1]) - offsetof(type, array[0]))

#endif
