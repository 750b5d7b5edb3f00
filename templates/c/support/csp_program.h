/* SPDX-License-Identifier: 0BSD */
/* A whole program and its run. */
#ifndef CSP_PROGRAM_H
#define CSP_PROGRAM_H

#include "csp_core.h"
#include "csp_external.h"

/* How a run ended, or why a step of it has. */
typedef enum csp_ending {
    CSP_TERMINATED,
    CSP_FAILED,
    CSP_DEADLOCK,
    CSP_TIME_LIMIT,
    CSP_STOPPED,
    CSP_NOT_INITIALIZED, /* nothing has run, because the network has to be built before each run */
    CSP_MORE,            /* the run continues: everything up to the instant is done */
    CSP_BUDGET,          /* the run continues: processes are ready, but the steps are used up */
    CSP_REFUSED          /* the run continues, and nothing was done: the instant is before the present one, or beyond the end of time */
} csp_ending;

/* The last instant of any run, after 292 years; later ones do not fit in int64_t. */
#define CSP_END_OF_TIME INT64_C(9223372036000000000)

/* The plant and the operator, simulated; functions may be NULL. They are passed the state, of which there may be several. */
typedef struct csp_environment {
    int64_t step;                                /* the grid in nanoseconds, on which event inputs are polled; 0: none */
    bool (*start)(csp_kernel *csp, void *state); /* evaluates the outputs at time 0, before processes run */
    bool (*advance)(csp_kernel *csp, void *state, int64_t now); /* advances to `now` with its inputs held; false: it has failed */
    void *state;
    void (*close)(void *state); /* closes the devices that `start` has opened, after the run */
} csp_environment;

typedef enum csp_port_kind { CSP_PORT_SAMPLED, CSP_PORT_EVENT, CSP_PORT_LATCHED, CSP_PORT_DIRECT } csp_port_kind;

/* A port of the outermost process. */
typedef struct csp_port {
    csp_port_kind kind;
    ptrdiff_t medium;   /* the distance from the kernel to the csp_sampled_input, csp_event_input, csp_latched_output or csp_direct_output */
    const void *safe;   /* of outputs: the value that is written at the end, however the run ends */
    const char *name;   /* "Jiwy.control_horizontal", for reports */
    uint32_t alike;     /* how many of the ports right after a sampled input or a latched output are of its kind and have its ticks */
} csp_port;

typedef struct csp_program {
    ptrdiff_t process;     /* the distance from the kernel to the outermost process */
    const csp_port *ports; /* in the order of the text */
    uint32_t port_count;
    const csp_environment *environment; /* NULL: none */
    int64_t grid; /* nanoseconds between polls of events without an environment, unless the hooks choose; 0: there are no events */
    /* For reports: each writes a text of at most `size` characters, including the terminating 0. */
    void (*process_name)(uint32_t number, char *text, size_t size);
    void (*channel_name)(uint32_t number, char *text, size_t size);
    const char *const *exception_names; /* of declared exceptions, from CSP_FIRST_EXCEPTION */
    const char *const *variable_names;  /* of those that may be read before they were written, by number; NULL without texts */
    /* What may change while the program runs; the size is 0 if there is nothing. */
    ptrdiff_t parameters; /* the distance from the kernel to the structure */
    size_t parameters_size;
    bool (*set_parameters)(csp_kernel *csp, const void *parameters); /* false: a value was refused, and nothing changed */
    const struct csp_tuning *tuning; /* what changes them during csp_run; NULL: nothing */
    bool reports_misses; /* the caller of csp_run reports missed samples, so the port does not */
} csp_program;

/* Why parameters were refused: a value is not finite, or a constant that follows from them cannot be computed. */
typedef enum csp_refusal_cause { CSP_ACCEPTED, CSP_NOT_FINITE, CSP_NOT_COMPUTED } csp_refusal_cause;
typedef struct csp_refusal {
    uint16_t cause;     /* csp_refusal_cause */
    uint16_t parameter; /* the number of the parameter or constant, in the order of the text */
} csp_refusal;

/* Changes of parameters in csp_run: the instant of the next one, INT64_MAX: none is known; and what makes those up to an instant. */
typedef struct csp_tuning {
    int64_t (*next)(void);
    void (*make)(csp_kernel *csp, int64_t instant);
} csp_tuning;

/* What a run asks of its owner. Functions may be NULL; they are passed `context`. */
typedef struct csp_hooks {
    void *context;
    bool real_time; /* whether time passes by itself; see csp_advance */
    /* Around accesses to what interrupt handlers and other threads bring. They may be nested: the result of `lock` is passed to `unlock`, which restores the
     * previous state. */
    uint32_t (*lock)(void *context);
    void (*unlock)(void *context, uint32_t outside);
    void (*wake)(void *context);                 /* an event or a request to stop has come, maybe from an interrupt handler */
    void (*alive)(void *context);                /* once in each turn, for a watchdog */
    void (*met)(void *context, int64_t instant); /* in real time: this instant is going to be executed */
    uint32_t (*cycles)(void *context);           /* with CSP_MEASURE: a counter of cycles of the processor, which may overflow */
    /* With CSP_MEASURE: how long a step of a process took, by its number from 1, or for 0 all work at an instant, or for CSP_OUTSIDE that of it outside of
     * steps. */
    void (*measured)(void *context, uint32_t process, uint32_t cycles);
    /* With CSP_TRACE_HOOK: a communication at csp->now, by the number of the channel or port and those of the processes; 0: the environment. */
    void (*trace)(void *context, uint32_t channel, const void *value, uint32_t writer, uint32_t reader);
    int64_t grid; /* nanoseconds between polls of events without an environment; 0: as the program has it */
} csp_hooks;

typedef enum csp_phase { CSP_NOT_BUILT, CSP_BUILT, CSP_RUNNING, CSP_FINISHED } csp_phase;

/* To be called first when a network is built, before each run: discards everything of an earlier run. `hooks` may be NULL: virtual time. */
void csp_build(csp_kernel *csp, const csp_program *program, const csp_hooks *hooks);

/* The parts of a program, which lie behind the kernel in the same memory. */
static inline csp_process *csp_outermost(csp_kernel *csp)
{
    return (csp_process *)(void *)((char *)csp + csp->program->process);
}
static inline csp_medium *csp_medium_of(csp_kernel *csp, const csp_port *port)
{
    return (csp_medium *)(void *)((char *)csp + port->medium);
}

/* A run in steps, without waiting anywhere:
 *
 *     csp_begin(csp)                  CSP_MORE, or CSP_FAILED if the environment has failed
 *     csp_advance(csp, until, steps)  runs everything that is due up to the instant, within this number of steps
 *     csp_next(csp)                   the next instant at which something is due; INT64_MAX: nothing is
 *     csp_hand_over(csp, instant)     writes the latched outputs of an instant, up to which everything is done, before csp_advance meets it
 *     csp_finish(csp)                 writes the safe values
 *
 * The time is that of the caller. In virtual time every instant is executed in its turn, however far `until` is ahead. In real time, `until` is
 * the present time, and everything up to it has passed: a tick that is followed by another one up to `until` is a missed sample. A run that has ended
 * answers in the same way again. */
csp_ending csp_begin(csp_kernel *csp);
csp_ending csp_advance(csp_kernel *csp, int64_t until, uint32_t steps);
int64_t csp_next(csp_kernel *csp);
void csp_hand_over(csp_kernel *csp, int64_t instant);
void csp_finish(csp_kernel *csp);

/* Runs to the end, or to the instant `until` (negative: without limit), and then writes the safe values. Afterwards `csp->now` is the time of the
 * end, and `csp->error` is the reason of a failure; if it has no exception, the environment has failed. */
csp_ending csp_run(csp_kernel *csp, int64_t until);

/* The hooks of csp_run: those of the platform (csp_port.h). */
const csp_hooks *csp_port_hooks(void);

/* The run that belongs to the whole process of the operating system, or to the machine, whose handlers stop it and release its outputs; NULL: none. csp_run
 * makes its run that one. */
void csp_own(csp_kernel *csp);
csp_kernel *csp_owned(void);

/* Makes the run end soon, with safe values; NULL: none. May be called by signal handlers and interrupt handlers. */
void csp_request_stop(csp_kernel *csp);

/* Writes the safe values now, if the run will not reach its end: for fault handlers of the processor. Each output gets its safe value once, and
 * no other value after that. Threads other than that of the run call csp_request_stop instead. */
void csp_release_outputs(csp_kernel *csp);
/* Whether safe values are being written, or have been. */
bool csp_is_releasing(csp_kernel *csp);
/* Around accesses to what interrupt handlers bring; may be nested. */
uint32_t csp_lock(csp_kernel *csp);
void csp_unlock(csp_kernel *csp, uint32_t outside);
/* Whether there is a run, and its outputs are not released. */
bool csp_is_driving(csp_kernel *csp);
/* Gives up the outputs: from now on nothing is written to them. */
void csp_forget_outputs(csp_kernel *csp);
/* The number of iterations of the run so far, for observers that check whether the present run makes progress. */
uint32_t csp_iterations(csp_kernel *csp);

/* ---- Reports ---- */

/* A process that waits forever. */
typedef struct csp_waiting_process {
    const csp_process *process;
    const csp_place *place;
} csp_waiting_process;

/* Called once for every process that waits, in the order of the text. */
typedef void csp_report(csp_kernel *csp, const csp_waiting_process *waiting, void *context);
void csp_report_waiting(csp_kernel *csp, csp_report *report, void *context);

typedef struct csp_wait_entry {
    const char *words; /* "to read", "to write", "until", "after", "skip"... */
    bool named;        /* whether it waits at a channel or port: */
    uint32_t channel;  /* its number */
    int64_t duration;  /* of "after"; the instant of "until" */
    const csp_medium *medium; /* the channel or port, if `named` */
} csp_wait_entry;

/* One of the things that the process waits for, numbered from 0; false: there is none with this index. */
bool csp_wait_of(const csp_waiting_process *waiting, uint32_t index, csp_wait_entry *entry);

/* A line: "Ring.cell[3] waits to read Ring.link[2] (ring.csp:12)". */
void csp_describe_waiting(csp_kernel *csp, const csp_waiting_process *waiting, char *text, size_t size);
/* Descriptions of csp->error: the name of the exception; its message; its place, as "Jiwy.alignLH.velocity (laws.csp:12)"; and all three, as
 * "Fault: division by zero, in Jiwy.alignLH.velocity (laws.csp:12)". */
const char *csp_exception_name(csp_kernel *csp);
void csp_describe_message(csp_kernel *csp, char *text, size_t size);
void csp_describe_place(csp_kernel *csp, char *text, size_t size);
/* What the run is doing, for another thread that finds it hanging: "the device function of Machine.level has not returned". */
void csp_describe_present(csp_kernel *csp, char *text, size_t size);
/* Which process is running and where, for another thread: "Main (loops.csp:12)", the place of a loop in which it cannot wait, or else "Main (last
 * waited at loops.csp:12)"; "": none. */
void csp_describe_at_work(csp_kernel *csp, char *text, size_t size);
/* The same for a fault handler, also after the outputs have been released. */
void csp_describe_current(csp_kernel *csp, char *text, size_t size);
/* What a signal handler or `exit` has interrupted, for the thread of the run: "the device function of Machine.level", a process as above, or "the
 * environment"; "": nothing runs. */
void csp_describe_interrupted(csp_kernel *csp, char *text, size_t size);
/* The ports with missed samples, and how many: "level 3, speed 1"; "none". */
void csp_describe_missed(csp_kernel *csp, char *text, size_t size);
void csp_describe_error(csp_kernel *csp, char *text, size_t size);

#endif
