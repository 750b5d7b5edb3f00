/* A whole program and its run. */
#ifndef CSP_PROGRAM_H
#define CSP_PROGRAM_H

#include "csp_core.h"
#include "csp_external.h"

/* How a run ended. */
typedef enum csp_ending {
    CSP_TERMINATED,
    CSP_FAILED,
    CSP_DEADLOCK,
    CSP_TIME_LIMIT,
    CSP_STOPPED,
    CSP_NOT_INITIALIZED /* nothing has run: the network has to be built before each run */
} csp_ending;

/* The plant and the operator, simulated; functions may be NULL. */
typedef struct csp_environment {
    int64_t step;                 /* the grid in nanoseconds, on which event inputs are polled; 0: none */
    bool (*start)(void);          /* evaluates the outputs at time 0, before anything runs */
    bool (*advance)(int64_t now); /* goes on to `now` with its inputs held; false: it has failed */
} csp_environment;

typedef enum csp_port_kind { CSP_PORT_SAMPLED, CSP_PORT_EVENT, CSP_PORT_LATCHED, CSP_PORT_DIRECT } csp_port_kind;

/* A port of the outermost process. */
typedef struct csp_port {
    csp_port_kind kind;
    csp_medium *medium; /* csp_sampled_input, csp_event_input, csp_latched_output or csp_direct_output */
    const void *safe;   /* outputs: what is handed over at the end, whatever that is */
    const char *name;   /* "Jiwy.control_horizontal", for reports */
} csp_port;

typedef struct csp_program {
    csp_process *process;  /* the outermost */
    const csp_port *ports; /* in the order of the text */
    uint32_t port_count;
    const csp_environment *environment; /* NULL: none */
    /* For reports: each writes a text of at most `size` characters with the 0 that ends it. */
    void (*process_name)(uint32_t number, char *text, size_t size);
    void (*channel_name)(uint32_t number, char *text, size_t size);
    const char *const *exception_names; /* of the declared ones, from CSP_FIRST_EXCEPTION */
    bool tells_misses; /* who runs it says how many samples were missed: the port does not */
} csp_program;

/* Called first by what builds a network: nothing is left of an earlier run. */
void csp_begin_building(void);

/* Runs to the end, or to the instant `until` (negative: for ever), and then hands over the safe values. Afterwards `csp.now` is the time of
 * the end, and `csp.error` tells why it has failed; no exception there: the environment has failed. */
csp_ending csp_run(const csp_program *program, int64_t until);

/* The run ends soon, with safe values. A signal handler or an interrupt handler may call it. */
void csp_request_stop(void);

/* Hands the safe values over now, where the run will not come to its end: for handlers of faults of the processor. Each output gets its
 * own once, and no other value after that. Other threads than that of the run call csp_request_stop. */
void csp_release_outputs(void);
/* Whether there is a run whose outputs are not released. */
bool csp_is_driving(void);
/* The outputs are somebody else's from here on: nothing is handed over to them any more. */
void csp_forget_outputs(void);
/* How many turns runs have made; for who looks on whether this one goes on. */
uint32_t csp_turns(void);

/* ---- Reports ---- */

/* A process that can never go on. */
typedef struct csp_waiting_process {
    const csp_process *process;
    const csp_place *place;
} csp_waiting_process;

/* Called once for every process that waits, in the order of the text. */
typedef void csp_report(const csp_program *program, const csp_waiting_process *waiting);
void csp_report_waiting(const csp_program *program, csp_report *report);

typedef struct csp_wait_entry {
    const char *words; /* "to read", "to write", "for a delay to pass", "after", "skip"... */
    bool named;        /* at a channel or port: */
    uint32_t channel;  /* its number */
    int64_t duration;  /* of "after" */
    const csp_medium *medium; /* where it is named */
} csp_wait_entry;

/* One of the things that the process waits for, counted from 0; false: there are no more. */
bool csp_wait_of(const csp_waiting_process *waiting, uint32_t index, csp_wait_entry *entry);

/* A line: "Ring.cell[3] waits to read Ring.link[2] (ring.csp:12)". */
void csp_describe_waiting(const csp_program *program, const csp_waiting_process *waiting, char *text, size_t size);
/* csp.error: the name of the exception; what it says; "Jiwy.alignLH.velocity (laws.csp:12)"; and all three: "Fault: division by zero, in Jiwy.alignLH.velocity (laws.csp:12)". */
const char *csp_exception_name(const csp_program *program);
void csp_describe_message(const csp_program *program, char *text, size_t size);
void csp_describe_place(const csp_program *program, char *text, size_t size);
/* What the run does at present, for another thread that finds it hanging: "the device function of Machine.level has not come back". */
void csp_describe_present(char *text, size_t size);
/* Which process runs at present, for another thread, and where: "Main (loops.csp:12)", of a loop in which it cannot wait, or else "Main (last
 * waited at loops.csp:12)"; "": none does. */
void csp_describe_at_work(char *text, size_t size);
/* The ports whose samples were overwritten untaken, and how many: "level 3, speed 1"; "none". */
void csp_describe_missed(const csp_program *program, char *text, size_t size);
void csp_describe_error(const csp_program *program, char *text, size_t size);

#endif
