/* SPDX-License-Identifier: 0BSD */
/* Ports of the outermost process, which connect a program to its environment. */
#ifndef CSP_EXTERNAL_H
#define CSP_EXTERNAL_H

#include "csp_core.h"

/* A device, or a simulated plant, at one port. Functions may be NULL. */
typedef struct csp_driver {
    void *device;
    /* For inputs: stores a value in `value`. False: no new sample of a sampled input, or no event. */
    bool (*read)(void *device, void *value);
    /* For outputs. */
    void (*write)(void *device, const void *value);
} csp_driver;

/* ---- Sampled inputs ---- */

typedef struct csp_sampled_end csp_sampled_end;
typedef struct csp_sampled_input csp_sampled_input;

struct csp_sampled_input {
    csp_medium medium;
    bool sampled; /* there has been at least one sample */
    bool counts;  /* missed samples are counted instead of raising Timeout */
    csp_driver driver;
    int64_t period;
    int64_t next; /* next tick; the first is at the period, or at the offset that is stored here before ends are initialized */
    void *value;  /* the present sample */
    uint32_t missed;
    csp_sampled_end *ends; /* in the order of their initialization */
};

/* The reading ends of one process, closed when it ends. Those with the same ticks pace each other. */
typedef struct csp_ends {
    csp_sampled_end *first;
} csp_ends;

struct csp_sampled_end {
    csp_medium medium;
    bool begun;    /* its session has begun */
    bool fresh;    /* there is a sample that has not been taken */
    bool overdue;  /* a sample was overwritten */
    bool followed; /* only of the first end of a process with these ticks: the process follows them */
    csp_sampled_input *port;
    csp_sampled_end *next;          /* the next end of the port */
    csp_sampled_end *next_of_owner; /* the next end of the process */
    csp_sampled_end *pace;          /* the first end of the process with the same ticks */
    csp_party *reader;
    csp_guard *inputs;
};

/* The general case of csp_sampled_read; CSP_FAILS may also mean Timeout. */
csp_progress csp_sampled_read_any(csp_kernel *csp, csp_party *party, csp_sampled_end *end, void *value, size_t size);

/* CSP_AWAIT(csp_sampled_read(...), csp_sampled_read_again(...), ...) */
static inline csp_progress csp_sampled_read(csp_kernel *csp, csp_party *party, csp_sampled_end *end, void *value, size_t size)
{
    if ((CSP_SMALL == 0) && end->fresh && end->begun && !end->overdue && (end->inputs == NULL) && !csp_is_cancelled(party)) {
        end->fresh = false;
        csp_copy(value, end->port->value, size);
        csp_observe(csp, end->medium.number, value, 0U, party->number);
        return CSP_DONE;
    }
    return csp_sampled_read_any(csp, party, end, value, size);
}

static inline csp_progress csp_sampled_read_again(csp_kernel *csp, csp_party *party, csp_sampled_end *end, void *value, size_t size)
{
    return csp_sampled_read(csp, party, end, value, size);
}

/* Closes the ends of a process or a scope that has ended. */
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
    void *value;          /* the value of the latest event */
    void *brought;        /* room for one more value, if interrupt handlers bring events; or NULL */
    size_t brought_size;
    volatile bool news;   /* `brought` has a value */
    csp_event_end *ends;  /* one that all readers share, or with broadcast one for each reader */
    csp_event_end shared; /* not used with broadcast */
} csp_event_input;

/* CSP_AWAIT(csp_event_read(...), csp_event_read_again(...), ...) */
csp_progress csp_event_read(csp_kernel *csp, csp_party *party, csp_event_end *end, void *value, size_t size);
csp_progress csp_event_read_again(csp_kernel *csp, csp_party *party, csp_event_end *end, void *value, size_t size);

/* The environment offers a value, which is in `port->value`; not for interrupt handlers. */
void csp_event_occur(csp_kernel *csp, csp_event_input *port);
/* Called by an interrupt handler to bring an event, which occurs between two steps of processes. The latest value counts: returns whether one
 * before it has not been read, which is lost unless it is read in the present step. Not to be called before the network is built. */
bool csp_event_bring(csp_kernel *csp, csp_event_input *port, const void *value);
/* Makes the event occur that an interrupt handler has brought. */
void csp_event_take_over(csp_kernel *csp, csp_event_input *port);

/* ---- Outputs ---- */

/* A sampled output: a latch of one place. */
typedef struct csp_latched_output {
    csp_medium medium;
    bool written;     /* since the last tick */
    const char *name; /* "Jiwy.control_horizontal", for faults */
    uint32_t writer; /* the process that wrote last */
    csp_driver driver;
    int64_t period;
    int64_t next; /* next tick; the first is at the period, or at the offset that is stored here */
    void *value;
} csp_latched_output;

/* An event output or an immediate output: writes each value to the device immediately. */
typedef struct csp_direct_output {
    csp_medium medium;
    const char *name;
    csp_driver driver;
} csp_direct_output;

/* Generated code checks before that no part of the value is NaN or infinite, and that the process is not cancelled. Always CSP_DONE. */
static inline csp_progress csp_latched_write(csp_party *party, csp_latched_output *output, void *value, size_t size)
{
    csp_copy(output->value, value, size);
    output->written = true;
    output->writer = party->number;
    return CSP_DONE;
}

csp_progress csp_direct_write(csp_kernel *csp, csp_party *party, csp_direct_output *output, void *value, size_t size);

/* ---- Before the program starts ---- */

void csp_sampled_input_init(csp_sampled_input *port, uint32_t number, int64_t period, void *value, const csp_driver *driver);
/* `owner` are the ends of the process or scope that reads, initialized to {NULL}. Ends are served in the order of these calls. */
void csp_sampled_end_init(csp_sampled_end *end, csp_sampled_input *port, csp_ends *owner);
void csp_event_input_init(csp_event_input *port, uint32_t number, bool broadcast, void *value, const csp_driver *driver);
/* Provides the memory in which interrupt handlers store the value of an event. */
void csp_event_input_accept(csp_event_input *port, void *brought, size_t size);
/* The end for a reader: `own` with broadcast, otherwise the shared one. */
csp_event_end *csp_event_reader(csp_event_end *own, csp_event_input *port);
void csp_latched_output_init(csp_latched_output *output, uint32_t number, int64_t period, void *value,
                             const csp_driver *driver);
void csp_direct_output_init(csp_direct_output *output, uint32_t number, const csp_driver *driver);

#endif
