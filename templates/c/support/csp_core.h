/* SPDX-License-Identifier: 0BSD */
/* The kernel of CSP programs: processes, channels, alternatives, time. C99, no heap, no recursion.
 *
 * A *party* is what can be ready or wait at one channel: a process, or one of several communications that a process
 * has offered concurrently. A *process* is a party at the beginning of a struct of its own, with a step function:
 *
 *     csp_party *cell_step(csp_kernel *csp, csp_party *party);
 *
 * The scheduler calls the step function of a ready party. It runs until the process has to wait; then it stores in
 * `party->state` the *place* where it waits and returns NULL. Called again, it continues at that place. If it returns a
 * party, that one runs next: a process called in sequence, or the caller of one that has ended. So there is a
 * single loop that calls step functions, and no recursion.
 *
 * Every operation has three results: CSP_DONE; CSP_WAITS, if the party is registered with what it waits for; CSP_FAILS,
 * if `csp->error` holds an exception or the cancellation of the process. CSP_AWAIT (csp_process.h) handles all three.
 *
 * Each class of processes has a constant table of its places: what the process waits for there, where that is in the program's
 * text, and in which state the process continues if the operation fails. Only cancellation, exceptions and reports read the
 * table, so they cost nothing in normal operation.
 */
#ifndef CSP_CORE_H
#define CSP_CORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "csp_config.h" /* CSP_TRACE (0 or 1), CSP_LEVELS (of priority, at least 1) */
#include "csp_parts.h"

/* Compiled for size, every case is left to the function for all of them; otherwise the most common ones are inline. */
#ifdef __OPTIMIZE_SIZE__
#define CSP_SMALL 1
#else
#define CSP_SMALL 0
#endif

/* A function that only failures call: once in the image, and nowhere inline. */
#ifdef __GNUC__
#define CSP_COLD __attribute__((cold, noinline))
#else
#define CSP_COLD
#endif

typedef struct csp_party csp_party;
typedef struct csp_process csp_process;
typedef struct csp_class csp_class;
typedef struct csp_place csp_place;
typedef struct csp_alternative csp_alternative;
typedef struct csp_guard csp_guard;
typedef struct csp_timer csp_timer;
typedef struct csp_medium csp_medium;
typedef struct csp_kernel csp_kernel;

/* Runs a ready party. Returns the party to run next, or NULL. */
typedef csp_party *csp_step(csp_kernel *csp, csp_party *party);

typedef enum csp_progress { CSP_DONE = 0, CSP_WAITS = 1, CSP_FAILS = 2 } csp_progress;

/* Flags of a party. */
enum {
    CSP_CANCELLED = 1, /* ends at its next communication */
    CSP_ABANDONED = 2, /* was cancelled while it waited: continues in the failed state of its place */
    CSP_ENDED = 4,     /* does not run */
    CSP_BRANCH = 8,    /* is a branch of a parallel or an interrupt */
    CSP_OFFERED = 16   /* is not a process, but one of several communications that a process has offered */
};

struct csp_party {
    csp_party *next; /* in the ready queue, or in the queue of a channel */
    csp_step *step;
    void *slot;      /* the variable that a partner reads from or writes to */
    uint16_t state;  /* the place where it waits; 0 before it has begun */
    uint8_t flags;
    uint8_t level;   /* of priority; 0 is the highest */
    uint32_t number; /* of the process in the program, from 1, for traces and reports */
};

struct csp_process {
    csp_party party;
    void *above;           /* of a branch: its csp_parallel; otherwise the csp_process that called it, or NULL for the outermost one */
    const csp_class *kind; /* the class of the process */
};

struct csp_class {
    csp_step *step;
    const csp_place *places; /* by state */
    const char *name;
    const char *where;    /* where it is defined: "laws.csp:12" */
    size_t offset;        /* of the csp_process in its struct; 0 except for branches of a composition */
    uint16_t stride;      /* from one csp_numbered to the next, if branches share a class; otherwise 0 */
    uint16_t states;      /* the length of `places`, where what is no state has no `where`; 0: not known, and not checked */
};

/* One of the branches of a composition that share a class: elements of an array, which differ in their number. */
typedef struct csp_numbered {
    csp_process process;
    uint32_t number; /* from 0 */
} csp_numbered;

/* What a process does at a place where it can wait or call. */
typedef enum csp_waiting {
    CSP_AT_NOTHING = 0,
    CSP_AT_CALL,        /* object: the csp_process that was called */
    CSP_AT_READ,        /* object: the channel or end */
    CSP_AT_WRITE,       /* object: the channel */
    CSP_AT_ALTERNATIVE, /* object: csp_alternative */
    CSP_AT_INPUTS,      /* object: csp_offers, of reads only */
    CSP_AT_OUTPUTS,     /* object: csp_offers, of writes only */
    CSP_AT_DELAY,       /* object: csp_timer */
    CSP_AT_STOP,
    CSP_AT_PARALLEL, /* object: csp_parallel */
    CSP_AT_INTERRUPT, /* object: csp_interrupt */
    CSP_AT_OVERWRITTEN /* the state of the process is none that its class has */
} csp_waiting;

struct csp_place {
    uint8_t waiting;  /* csp_waiting */
    bool indirect;    /* the member at `offset` is a pointer to the object (a port), not the object itself */
    uint16_t failed;  /* the state in which the process continues if the operation fails */
    uint32_t offset;  /* of the object in the struct of the process */
    uint32_t stride;  /* from the object of one csp_numbered to that of the next; 0: they share one object */
    const char *where; /* in the program's text: "laws.csp:12" */
    const char *inner; /* path of the process that was flattened into this one and to which the place belongs, or NULL */
};

/* An exception. Numbers of declared exceptions begin at CSP_FIRST_EXCEPTION. */
enum {
    CSP_NO_EXCEPTION = 0,
    CSP_CANCELLATION = 1, /* cannot be caught */
    CSP_FAULT_EXCEPTION = 2,
    CSP_TIMEOUT_EXCEPTION = 3,
    CSP_FIRST_EXCEPTION = 4
};

/* The values in a message, which is formatted only when it is shown. */
typedef struct csp_operands {
    int64_t integers[3];
    double real;
    const char *name;
} csp_operands;

typedef struct csp_error {
    uint16_t exception;
    const csp_process *process; /* the process that raised it; NULL: not known yet */
    const char *place;          /* in the program's text: "laws.csp:12" */
    const char *inner;          /* path below the process, or NULL */
    const char *law;            /* the control law below that, or NULL */
    void (*describe)(const csp_operands *operands, char *text, size_t size); /* writes the message; may be NULL */
    csp_operands operands;
} csp_error;

/* ---- Kernel ---- */

typedef struct csp_queue {
    csp_party *first;
    csp_party *last;
} csp_queue;

/* A fault that arithmetic has found, and that the process has not raised yet. */
typedef struct csp_fault_note {
    void (*describe)(const csp_operands *operands, char *text, size_t size); /* NULL: there was no fault */
    csp_operands operands;
    const char *place; /* "laws.csp:12"; NULL: not known yet */
    const char *law;   /* the control law in which it happened, or NULL */
} csp_fault_note;

#ifndef CSP_MEASURE
#define CSP_MEASURE 0 /* whether execution times are measured */
#endif

#define CSP_OUTSIDE UINT32_MAX /* instead of the number of a process: what the kernel and devices did at an instant */

/* What is being measured, in cycles. */
enum { CSP_DEEPEST = 6 };
typedef struct csp_measuring {
    uint32_t began;   /* the step */
    uint32_t entered; /* the present part of an instant, */
    uint32_t instant; /* and how long those before took */
    uint32_t steps;   /* how long the steps in it took */
    uint32_t depth;
    uint32_t running[CSP_DEEPEST]; /* the processes of the step */
} csp_measuring;

/* A range of numbers of ports, without its end. */
typedef struct csp_range {
    uint32_t from;
    uint32_t to;
} csp_range;

/* The whole state of a run, apart from the processes and ports of the program, which follow it in the same memory. It is passed to every function that
 * needs it, so there may be several runs at the same time. Flags come first and what is long last: instructions of small processors reach 32 bytes of flags
 * and 128 bytes of words. */
struct csp_kernel {
    /* The run */
    uint8_t phase;    /* csp_phase */
    uint8_t ending;   /* csp_ending: CSP_MORE, or how the run has ended */
    bool real_time;   /* ticks pass although nobody has met them */
    bool entered;     /* csp_advance has been called */
    volatile bool stop_requested;
    volatile bool news;    /* an interrupt handler has brought an event since the last were taken over */
    volatile bool driving; /* there are outputs that are not released */
    volatile bool closed;  /* only safe values are written */
    int64_t now;        /* nanoseconds since the start */
    csp_party *current; /* the party whose step function runs, or NULL */
    const struct csp_program *program;
    const struct csp_hooks *hooks;
    csp_timer *earliest; /* the root of the heap of timers; NULL: none */
    /* Instants */
    int64_t reached;   /* the one up to which the run has advanced */
    int64_t next_tick; /* of a port or the grid; INT64_MAX: none */
    int64_t grid;      /* the period at which the environment is evaluated and event inputs are polled; 0: none */
    int64_t next_grid; /* INT64_MAX: none */
    csp_range inputs;  /* the ports that include all inputs, */
    csp_range outputs; /* and all latched outputs */
    uint32_t begun;    /* number of alternatives that have begun to wait, modulo 2^32 */
    uint32_t changes;  /* how often the parameters have been set, modulo 2^32; 0: not yet */
    csp_queue ready[CSP_LEVELS];
    csp_fault_note fault;
    csp_error error; /* of the operation that has just failed */
    uint64_t timers_begun;
    uint32_t awaited; /* the port for which something waited last */
    volatile uint32_t iterations;
    const char *volatile loop; /* with CSP_TRACE: place of the loop in which the process is and in which it cannot wait; NULL: none */
    /* Devices */
    volatile uint32_t next_port;  /* the next port to get its safe value */
    const csp_medium *volatile called; /* for reports: the port whose device function is being called; NULL: none */
#if CSP_MEASURE
    csp_measuring measuring;
#endif
};

#ifndef CSP_TRACE_HOOK
#define CSP_TRACE_HOOK 0 /* without CSP_TRACE: whether the hook `trace` is called at communications */
#endif
void csp_call_trace(csp_kernel *csp, uint32_t channel, const void *value, uint32_t writer, uint32_t reader);

#if CSP_TRACE
/* To be defined by the main of the program. A communication: the number of the channel or external port, the value, and the numbers of the
 * processes that write and read, 0 for the environment. */
void csp_observe(csp_kernel *csp, uint32_t channel, const void *value, uint32_t writer, uint32_t reader);
/* A sample of a sampled input, at its tick, whether it is read or not. */
void csp_observe_sample(csp_kernel *csp, uint32_t port, const void *value);
/* A safe value is written to a device. */
void csp_observe_release(csp_kernel *csp, uint32_t port, const void *value);
/* A process (its number), or a named group or flattened process (numbered after the processes), has begun or ended. Called by generated code. */
void csp_observe_begin(csp_kernel *csp, uint32_t number);
void csp_observe_end(csp_kernel *csp, uint32_t number);
/* To be called at the beginning of a loop in which the process cannot wait, with its place in the program's text, and with NULL after the loop. */
#define csp_observe_loop(csp, where) ((csp)->loop = (where))
/* Reports a communication inside the process that was reduced to an assignment; `slot` holds its value during the report. */
#define CSP_REPORT(channel, slot, value)                                                                               \
    do {                                                                                                               \
        (slot) = (value);                                                                                              \
        csp_observe(csp, (channel), &(slot), party->number, party->number);                                                 \
    } while (0)
#else
#if CSP_TRACE_HOOK
#define csp_observe(csp, channel, value, writer, reader) csp_call_trace((csp), (channel), (value), (writer), (reader))
#else
#define csp_observe(csp, channel, value, writer, reader) ((void)(csp), (void)(channel), (void)(value), (void)(writer), (void)(reader))
#endif
#define csp_observe_sample(csp, port, value) ((void)(csp), (void)(port), (void)(value))
#define csp_observe_release(csp, port, value) ((void)(csp), (void)(port), (void)(value))
#define csp_observe_begin(csp, number) ((void)(csp), (void)(number))
#define csp_observe_end(csp, number) ((void)(csp), (void)(number))
#define csp_observe_loop(csp, where) ((void)(csp))
#define CSP_REPORT(channel, slot, value) ((void)0)
#endif

static inline void csp_enter(csp_queue *queue, csp_party *party)
{
    party->next = NULL;
    if (queue->first != NULL) {
        queue->last->next = party;
    } else {
        queue->first = party;
    }
    queue->last = party;
}

/* Puts a party that is not registered anywhere into the ready queue of its level. */
static inline void csp_ready(csp_kernel *csp, csp_party *party)
{
    csp_enter(&csp->ready[(CSP_LEVELS > 1U) ? party->level : 0U], party);
}

/* Copies a value; most values are one word. */
static inline void csp_copy(void *to, const void *from, size_t size)
{
    if (size == sizeof(uint64_t)) {
        (void)memcpy(to, from, sizeof(uint64_t));
    } else {
        (void)memcpy(to, from, size);
    }
}

static inline bool csp_is_cancelled(const csp_party *party)
{
    return (party->flags & (unsigned)CSP_CANCELLED) != 0U;
}

/* Sets `csp->error` to the cancellation of a process that has tried to communicate. Always CSP_FAILS. */
CSP_COLD csp_progress csp_refuse(csp_kernel *csp, const csp_party *party);

/* ---- The rendezvous of one writer and one reader, without guards, all inline ---- */

/* The first member of all channels and external ports. */
struct csp_medium {
    uint32_t number; /* for traces and reports */
    uint8_t kind;    /* csp_medium_kind */
};

#define CSP_MEDIUM(channel) ((csp_medium *)(void *)(channel))

typedef enum csp_medium_kind {
    CSP_CHANNEL,       /* csp_channel: sync, without guards anywhere */
    CSP_GUARDED,       /* csp_guarded_channel: sync, with guards of its reader only */
    CSP_ANY,           /* csp_any_channel: any, and sync with guards of its writer */
    CSP_BROADCAST,     /* csp_broadcast */
    CSP_BROADCAST_END, /* csp_broadcast_end */
    CSP_BUFFER,        /* csp_buffer: buffer and overwrite */
    CSP_SAMPLED_END,   /* csp_sampled_end */
    CSP_EVENT_END,     /* csp_event_end */
    CSP_AT_ONCE        /* inputs and outputs themselves, where processes never wait */
} csp_medium_kind;

typedef struct csp_channel {
    csp_medium medium;
    csp_party *waiting; /* the writer or the reader, whichever came first */
} csp_channel;

/* `party` is the process itself or an offer; a process checks csp_is_cancelled before. CSP_DONE or CSP_WAITS. */
static inline csp_progress csp_channel_write(csp_kernel *csp, csp_party *party, csp_channel *channel, void *value, size_t size)
{
    csp_party *const reader = channel->waiting;
    if (reader == NULL) {
        channel->waiting = party;
        party->slot = value;
        return CSP_WAITS;
    }
    channel->waiting = NULL;
    (void)memcpy(reader->slot, value, size);
    csp_ready(csp, reader);
    csp_observe(csp, channel->medium.number, value, party->number, reader->number);
    return CSP_DONE;
}

/* Takes the value of the writer that waits there. */
static inline void csp_channel_take(csp_kernel *csp, const csp_party *party, csp_channel *channel, void *value, size_t size)
{
    csp_party *const writer = channel->waiting;
    channel->waiting = NULL;
    csp_copy(value, writer->slot, size);
    csp_ready(csp, writer);
    csp_observe(csp, channel->medium.number, value, writer->number, party->number);
}

static inline csp_progress csp_channel_read(csp_kernel *csp, csp_party *party, csp_channel *channel, void *value, size_t size)
{
    if (channel->waiting == NULL) {
        channel->waiting = party;
        party->slot = value;
        return CSP_WAITS;
    }
    csp_channel_take(csp, party, channel, value, size);
    return CSP_DONE;
}

#endif
