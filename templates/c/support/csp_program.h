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

/* The plant and the operator, simulated; functions may be NULL. */
typedef struct csp_environment {
    int64_t step;                 /* the grid in nanoseconds, on which event inputs are polled; 0: none */
    bool (*start)(void);          /* evaluates the outputs at time 0, before processes run */
    bool (*advance)(int64_t now); /* advances to `now` with its inputs held; false: it has failed */
} csp_environment;

typedef enum csp_port_kind { CSP_PORT_SAMPLED, CSP_PORT_EVENT, CSP_PORT_LATCHED, CSP_PORT_DIRECT } csp_port_kind;

/* A port of the outermost process. */
typedef struct csp_port {
    csp_port_kind kind;
    csp_medium *medium; /* csp_sampled_input, csp_event_input, csp_latched_output or csp_direct_output */
    const void *safe;   /* of outputs: the value that is written at the end, however the run ends */
    const char *name;   /* "Jiwy.control_horizontal", for reports */
} csp_port;

typedef struct csp_program {
    csp_process *process;  /* the outermost */
    const csp_port *ports; /* in the order of the text */
    uint32_t port_count;
    const csp_environment *environment; /* NULL: none */
    /* For reports: each writes a text of at most `size` characters, including the terminating 0. */
    void (*process_name)(uint32_t number, char *text, size_t size);
    void (*channel_name)(uint32_t number, char *text, size_t size);
    const char *const *exception_names; /* of declared exceptions, from CSP_FIRST_EXCEPTION */
    bool reports_misses; /* the caller of csp_run reports missed samples, so the port does not */
} csp_program;

/* To be called first when a network is built: discards everything of an earlier run. */
void csp_begin_building(void);

/* A run in steps, without waiting anywhere:
 *
 *     csp_begin(program)           CSP_MORE, or CSP_FAILED if the environment has failed
 *     csp_advance(until, steps)    runs everything that is due up to the instant, within this number of steps
 *     csp_next()                   the next instant at which something is due; INT64_MAX: nothing is
 *     csp_finish()                 writes the safe values
 *
 * The time is that of the caller. In virtual time (csp_port.h) every instant is executed in its turn, however far `until` is ahead. Against a clock, `until` is
 * the present time, and everything up to it has passed: a tick that is followed by another one up to `until` is a missed sample. A run that has ended
 * answers in the same way again. */
csp_ending csp_begin(const csp_program *program);
csp_ending csp_advance(int64_t until, uint32_t steps);
int64_t csp_next(void);
void csp_finish(void);

/* Runs to the end, or to the instant `until` (negative: without limit), and then writes the safe values. Afterwards `csp.now` is the time of the
 * end, and `csp.error` is the reason of a failure; if it has no exception, the environment has failed. */
csp_ending csp_run(const csp_program *program, int64_t until);

/* Makes the run end soon, with safe values. May be called by signal handlers and interrupt handlers. */
void csp_request_stop(void);

/* Writes the safe values now, if the run will not reach its end: for fault handlers of the processor. Each output gets its safe value once, and
 * no other value after that. Threads other than that of the run call csp_request_stop instead. */
void csp_release_outputs(void);
/* Whether there is a run whose outputs are not released. */
bool csp_is_driving(void);
/* Gives up the outputs: from now on nothing is written to them. */
void csp_forget_outputs(void);
/* The number of iterations of all runs so far, for observers that check whether the present run makes progress. */
uint32_t csp_iterations(void);

/* ---- Reports ---- */

/* A process that waits forever. */
typedef struct csp_waiting_process {
    const csp_process *process;
    const csp_place *place;
} csp_waiting_process;

/* Called once for every process that waits, in the order of the text. */
typedef void csp_report(const csp_program *program, const csp_waiting_process *waiting);
void csp_report_waiting(const csp_program *program, csp_report *report);

typedef struct csp_wait_entry {
    const char *words; /* "to read", "to write", "for a delay to pass", "after", "skip"... */
    bool named;        /* whether it waits at a channel or port: */
    uint32_t channel;  /* its number */
    int64_t duration;  /* of "after" */
    const csp_medium *medium; /* the channel or port, if `named` */
} csp_wait_entry;

/* One of the things that the process waits for, numbered from 0; false: there is none with this index. */
bool csp_wait_of(const csp_waiting_process *waiting, uint32_t index, csp_wait_entry *entry);

/* A line: "Ring.cell[3] waits to read Ring.link[2] (ring.csp:12)". */
void csp_describe_waiting(const csp_program *program, const csp_waiting_process *waiting, char *text, size_t size);
/* Descriptions of csp.error: the name of the exception; its message; its place, as "Jiwy.alignLH.velocity (laws.csp:12)"; and all three, as
 * "Fault: division by zero, in Jiwy.alignLH.velocity (laws.csp:12)". */
const char *csp_exception_name(const csp_program *program);
void csp_describe_message(const csp_program *program, char *text, size_t size);
void csp_describe_place(const csp_program *program, char *text, size_t size);
/* What the run is doing, for another thread that finds it hanging: "the device function of Machine.level has not returned". */
void csp_describe_present(char *text, size_t size);
/* Which process is running and where, for another thread: "Main (loops.csp:12)", the place of a loop in which it cannot wait, or else "Main (last
 * waited at loops.csp:12)"; "": none. */
void csp_describe_at_work(char *text, size_t size);
/* The ports with missed samples, and how many: "level 3, speed 1"; "none". */
void csp_describe_missed(const csp_program *program, char *text, size_t size);
void csp_describe_error(const csp_program *program, char *text, size_t size);

#endif
