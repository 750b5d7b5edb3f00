/* Ports of the outermost process: where a program meets its environment. */
#ifndef CSP_EXTERNAL_H
#define CSP_EXTERNAL_H

#include "csp_core.h"

/* A device, or a plant, at one port. Functions may be NULL. */
typedef struct csp_driver {
    void *device;
    /* Inputs: puts a value into `value`. False: a sampled input has no new sample; an event input has no event. */
    bool (*read)(void *device, void *value);
    /* Outputs. */
    void (*write)(void *device, const void *value);
} csp_driver;

/* ---- Sampled inputs ---- */

typedef struct csp_sampled_end csp_sampled_end;
typedef struct csp_sampled_input csp_sampled_input;

struct csp_sampled_input {
    csp_medium medium;
    bool sampled; /* there has been a sample */
    bool counts;  /* missed samples are counted and raise no Timeout */
    csp_driver driver;
    int64_t period;
    int64_t next; /* tick; the first is at the period, or at the offset that is stored here before there are ends */
    void *value;  /* the present sample */
    uint32_t missed;
    csp_sampled_end *ends; /* in the order in which they were made */
};

/* The reading ends of one process, closed when it ends. Those with the same ticks pace each other. */
typedef struct csp_ends {
    csp_sampled_end *first;
} csp_ends;

struct csp_sampled_end {
    csp_medium medium;
    bool begun;    /* its session */
    bool fresh;    /* there is a sample that was not taken */
    bool overdue;  /* one was overwritten */
    bool followed; /* of the first end of its process and ticks: the process follows these */
    csp_sampled_input *port;
    csp_sampled_end *next;          /* of the port */
    csp_sampled_end *next_of_owner; /* of the process */
    csp_sampled_end *pace;          /* the first end of its process and ticks */
    csp_party *reader;
    csp_guard *inputs;
};

/* In general; CSP_FAILS also with Timeout. */
csp_progress csp_sampled_read_any(csp_party *party, csp_sampled_end *end, void *value, size_t size);

/* CSP_AWAIT(csp_sampled_read(...), csp_sampled_read_again(...), ...) */
static inline csp_progress csp_sampled_read(csp_party *party, csp_sampled_end *end, void *value, size_t size)
{
    if (end->fresh && end->begun && !end->overdue && (end->inputs == NULL) && !csp_is_cancelled(party)) {
        end->fresh = false;
        csp_copy(value, end->port->value, size);
        csp_observe(end->medium.number, value, 0U, party->number);
        return CSP_DONE;
    }
    return csp_sampled_read_any(party, end, value, size);
}

static inline csp_progress csp_sampled_read_again(csp_party *party, csp_sampled_end *end, void *value, size_t size)
{
    return csp_sampled_read(party, end, value, size);
}

/* The process, or the scope, that has these ends has ended. */
void csp_ends_close(csp_ends *ends);

/* ---- Event inputs ---- */

/* A latch that keeps the latest value until it is read. */
typedef struct csp_event_end {
    csp_medium medium;
    bool fresh;
    struct csp_event_input *port;
    struct csp_event_end *next;
    csp_queue readers;
    csp_guard *inputs;
} csp_event_end;

typedef struct csp_event_input {
    csp_medium medium;
    bool broadcast;
    csp_driver driver;
    void *value;          /* of the latest event */
    void *brought;        /* a place for one more value, where interrupt handlers bring events; or NULL */
    size_t brought_size;
    volatile bool news;   /* it has a value */
    csp_event_end *ends;  /* the one that all readers share, or one for each under broadcast */
    csp_event_end shared; /* not used under broadcast */
} csp_event_input;

/* CSP_AWAIT(csp_event_read(...), csp_event_read_again(...), ...) */
csp_progress csp_event_read(csp_party *party, csp_event_end *end, void *value, size_t size);
csp_progress csp_event_read_again(csp_party *party, csp_event_end *end, void *value, size_t size);

/* The environment offers a value, which is in `port->value`; not for interrupt handlers. */
void csp_event_occur(csp_event_input *port);
/* An interrupt handler brings an event: it occurs between two steps of processes. The latest value counts. Before the network is built
 * there is nobody to bring it to. */
void csp_event_bring(csp_event_input *port, const void *value);
/* Makes what was brought occur. */
void csp_event_take_over(csp_event_input *port);

/* ---- Outputs ---- */

/* A sampled output: a latch of one place. */
typedef struct csp_latched_output {
    csp_medium medium;
    bool written;     /* since its last tick */
    const char *name; /* "Jiwy.control_horizontal", for faults */
    uint32_t writer; /* the process that wrote last */
    csp_driver driver;
    int64_t period;
    int64_t next; /* tick; the first is at the period, or at the offset that is stored here */
    void *value;
} csp_latched_output;

/* An event output or an immediate one: hands each value over at once. */
typedef struct csp_direct_output {
    csp_medium medium;
    const char *name;
    csp_driver driver;
} csp_direct_output;

/* Whether a value has NaN or infinite parts is asked by generated code before. Always CSP_DONE; a process asks csp_is_cancelled before. */
static inline csp_progress csp_latched_write(csp_party *party, csp_latched_output *output, void *value, size_t size)
{
    csp_copy(output->value, value, size);
    output->written = true;
    output->writer = party->number;
    return CSP_DONE;
}

csp_progress csp_direct_write(csp_party *party, csp_direct_output *output, void *value, size_t size);

/* ---- Before the program starts ---- */

void csp_sampled_input_init(csp_sampled_input *port, uint32_t number, int64_t period, void *value, csp_driver driver);
/* `owner` are the ends of the process or scope that reads; initialized to {NULL}. The order of calls is that of service. */
void csp_sampled_end_init(csp_sampled_end *end, csp_sampled_input *port, csp_ends *owner);
void csp_event_input_init(csp_event_input *port, uint32_t number, bool broadcast, void *value, csp_driver driver);
/* The place where interrupt handlers bring events. */
void csp_event_input_accept(csp_event_input *port, void *brought, size_t size);
/* The end of a reader, whichever of the two it is: `own` under broadcast. */
csp_event_end *csp_event_reader(csp_event_end *own, csp_event_input *port);
void csp_latched_output_init(csp_latched_output *output, uint32_t number, int64_t period, void *value,
                             csp_driver driver);
void csp_direct_output_init(csp_direct_output *output, uint32_t number, csp_driver driver);

#endif
