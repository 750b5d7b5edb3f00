/* Many runs of a program in one process: parameters come in, what was measured goes out, both as records without text. */
#ifndef CSP_SWEEP_H
#define CSP_SWEEP_H

#include "csp_program.h"

/* What is run again and again. */
typedef struct csp_sweep {
    csp_kernel *csp;
    const csp_environment *environment; /* NULL: none */
    size_t environment_size;            /* of its state, which is cleared before each run */
    bool counts_misses;                 /* missed samples are counted instead of raising Timeout */
    size_t parameters_size;
    bool (*connect)(const void *parameters); /* builds the network; false: it cannot have the parameters */
    const size_t *states;                    /* where the states of the environment are in its state */
    uint32_t state_count;
} csp_sweep;

/* Reads from standard input, in the byte order and with the alignment of the machine, a csp_sweep_head, its signals and its measures; then, for each run,
 * the structure of the parameters, if there is one, or else a single byte. After each run it writes a csp_sweep_result, the measured values, and a text if
 * the run has failed: three strings, each with its terminating 0, for exception, message and place. It ends with its input. The first argument is the descriptor of a pipe: the process
 * ends at once when the other end is closed. Returns the status for `main`. */
int csp_sweep_run(const csp_sweep *sweep, int argument_count, char *const *arguments);

typedef struct csp_sweep_head {
    int64_t until; /* the longest run in nanoseconds; negative: without limit */
    uint32_t signals;
    uint32_t measures;
} csp_sweep_head;

/* A number that is observed: a port of the program, or a part of it; or a state of the environment. */
typedef struct csp_sweep_signal {
    uint32_t number; /* of the port, or of the state */
    uint32_t offset; /* of the part */
    uint32_t type;   /* the letter of its type in the module `struct` of Python; T: a time */
    uint32_t state;  /* 1: a state of the environment; 0: a port */
} csp_sweep_signal;

/* What is measured of a signal, or of its distance to another one. Values are held from one instant to the next; of several at one instant the last counts. */
enum {
    CSP_SWEEP_MAX,
    CSP_SWEEP_MIN,
    CSP_SWEEP_PEAK,     /* the largest absolute value */
    CSP_SWEEP_MEAN,     /* over time, from the first value to the end of the run */
    CSP_SWEEP_RMS,      /* the root of the mean of squares */
    CSP_SWEEP_LAST,
    CSP_SWEEP_INTEGRAL, /* over time */
    CSP_SWEEP_SETTLING, /* the seconds after which it stays within `tolerance` of `target` */
    CSP_SWEEP_OVERSHOOT /* how far it goes beyond `target`, seen from its first value */
};

#define CSP_SWEEP_NOTHING UINT32_MAX

typedef struct csp_sweep_measure {
    uint32_t kind;
    uint32_t signal;
    uint32_t subtracted; /* another signal; CSP_SWEEP_NOTHING: none */
    uint32_t absolute;   /* 1: the absolute value */
    double target;
    double tolerance;
} csp_sweep_measure;

typedef struct csp_sweep_result {
    int64_t time; /* the end of the run in nanoseconds */
    int32_t ending; /* csp_ending */
    uint32_t text;  /* the bytes of the text */
} csp_sweep_result;

#endif
