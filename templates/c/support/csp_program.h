/* A whole program and its run. */
#ifndef CSP_PROGRAM_H
#define CSP_PROGRAM_H

#include "csp_core.h"
#include "csp_external.h"

/* How a run ended. */
typedef enum csp_ending { CSP_TERMINATED, CSP_FAILED, CSP_DEADLOCK, CSP_TIME_LIMIT, CSP_STOPPED } csp_ending;

/* The plant and the operator, simulated; functions may be NULL. */
typedef struct csp_environment {
    int64_t step;                  /* the grid; 0: none */
    void (*start)(void);           /* evaluates the outputs at time 0, before event inputs read their first value */
    bool (*advance)(int64_t now);  /* goes on to `now` with its inputs held; false: it has failed, with csp.error */
} csp_environment;

/* A port of the outermost process, in the order of the text. */
typedef struct csp_port {
    csp_medium *medium; /* csp_sampled_input, csp_event_input, csp_latched_output or csp_direct_output: see `kind` */
    enum { CSP_PORT_SAMPLED, CSP_PORT_EVENT, CSP_PORT_LATCHED, CSP_PORT_DIRECT } kind;
    const char *name;
    const void *safe; /* outputs: what is handed over at the end, whatever that is */
} csp_port;

typedef struct csp_program {
    csp_process *process; /* the outermost */
    const csp_port *ports;
    uint32_t port_count;
    csp_environment environment;
    const char *(*process_name)(uint32_t number, char *text, size_t size); /* its path; may be NULL */
    const char *(*channel_name)(uint32_t number, char *text, size_t size);
    const char *(*exception_name)(uint16_t exception);
} csp_program;

/* Runs to the end, or to `until` (negative: for ever), and then hands over the safe values. Afterwards `csp.now` is the time of the end, and
 * `csp.error` why it has failed. */
csp_ending csp_run(const csp_program *program, int64_t until);

/* Who waits, for what, and where, as a line each: called for each waiting process, in the order of the text. */
typedef void csp_report(const char *line);
void csp_report_waiting(const csp_program *program, csp_report *report);
/* Exception, message, process and line of csp.error. */
void csp_describe_error(const csp_program *program, char *text, size_t size);

/* For the port: the run is to end soon, with safe values (a signal handler may call it). */
void csp_request_stop(void);

#endif
