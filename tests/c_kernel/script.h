/* Processes for tests of the kernel: each executes a list of steps.
 *
 * A step function like the generated ones executes the list; the state of the process is the number of the step where it waits, plus 1.
 * Every communication is printed as it happens, so a test is a scenario and the trace that it must produce. */
#ifndef SCRIPT_H
#define SCRIPT_H

#include "csp.h"

enum { SCRIPT_STEPS = 24, SCRIPT_OFFERS = 4, SCRIPT_PORTS = 8 };

typedef enum script_action {
    END = 0, /* the process ends; or, if `exception` is set, it is raised */
    READ,    /* from `medium` into the value of the process */
    WRITE,   /* `value` to `medium`; 0: the value of the process */
    SELECT,  /* from `alternative`; continues at step `jump` + index of the guard chosen */
    JUMP,    /* continues at step `jump` */
    REPEAT,  /* continues at step `jump`, `value` times in all */
    DELAY,   /* `value` milliseconds */
    STOP,
    CALL,      /* `process` in sequence */
    PARALLEL,  /* `branches` */
    INTERRUPT, /* body `process`, guard on `medium` of kind `value`; continues at step `jump` if the guard was taken */
    OFFER,     /* one of several concurrent reads or writes: begun together with the next ones, up to a step TOGETHER */
    TOGETHER,  /* waits for the offers before it */
    RAISE,     /* `exception` */
    TRY,       /* from here on `exception` is caught, and the process continues at step `jump` */
    SAY        /* prints `text` and the value */
} script_action;

typedef struct script script;

typedef struct script_step {
    script_action action;
    csp_medium *medium;
    int64_t value;
    uint16_t jump;
    uint16_t exception;
    script *process;
    csp_alternative *alternative;
    const csp_branches *branches;
    uint32_t branch_runs;
    const char *text;
    bool writes; /* an offer; or the guard of an interrupt */
    int rank;    /* a guard with `after`: its milliseconds */
} script_step;

typedef script_step script_list[SCRIPT_STEPS];

struct script {
    csp_process process; /* first, as in generated structs */
    const script_step *steps;
    const char *name;
    int64_t value;
    int64_t written;
    int64_t repeated;
    uint16_t handler; /* of the exception `caught` */
    uint16_t caught;
    csp_medium *waits_at[SCRIPT_STEPS];
    csp_ends ends;
    csp_timer timer;
    csp_parallel parallel;
    csp_interrupt interrupt;
    csp_offers offers;
    csp_offer offer[SCRIPT_OFFERS];
    int64_t offered[SCRIPT_OFFERS];
    csp_place places[SCRIPT_STEPS + 2];
    csp_class kind;
};

/* Branches and called processes are in an array of scripts: offsets count from `parent`. */
void script_init(script *self, uint32_t number, const char *name, const script_step *steps);

/* A port of the program, as csp_port. */
typedef struct script_port {
    csp_port_kind kind;
    csp_medium *medium;
    const void *safe;
} script_port;

extern csp_kernel script_kernel;

/* Runs the first of `scripts`, and prints how that ends. Names of channels by number. */
void script_run(script *scripts, const char *const *channel_names, const script_port *ports, uint32_t port_count,
                csp_environment *environment, int64_t until);

#endif
