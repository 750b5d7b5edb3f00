/* Channels that alternatives guard, with many users, with memory, and to many readers. */
#ifndef CSP_CHANNELS_H
#define CSP_CHANNELS_H

#include "csp_core.h"
#include "csp_offers.h"

/* All operations: `party` is the process, or the csp_offer's; the result is CSP_DONE or CSP_WAITS. A process asks csp_is_cancelled before
 * (the macro CSP_COMMUNICATE does), and goes on as done when it runs again. `value` is the variable to read into, or to write from:
 * it must live as long as the process waits. */

/* ---- Rendezvous: `any`, and `sync` where a guard is on the channel ---- */

typedef struct csp_any_channel {
    csp_medium medium;
    csp_queue readers; /* of them and the writers at most one is not empty */
    csp_queue writers;
    csp_guard *inputs;  /* guards that watch for a writer, and for a reader */
    csp_guard *outputs;
    csp_guard *reading; /* guards of alternatives that wait, where the other side alternates too */
    csp_guard *writing;
} csp_any_channel;

csp_progress csp_any_read(csp_party *party, csp_any_channel *channel, void *value, size_t size);
csp_progress csp_any_write(csp_party *party, csp_any_channel *channel, void *value, size_t size);

/* ---- Memory ---- */

typedef struct csp_buffer {
    csp_medium medium;
    bool overwrites; /* the oldest, when it is full */
    uint32_t capacity;
    uint32_t stored;
    uint32_t first;
    unsigned char *values; /* of capacity * size of a value */
    csp_party *reader;
    csp_party *writer;
    csp_guard *inputs;
    csp_guard *outputs;
} csp_buffer;

csp_progress csp_buffer_read(csp_party *party, csp_buffer *buffer, void *value, size_t size);
csp_progress csp_buffer_write(csp_party *party, csp_buffer *buffer, void *value, size_t size);

/* ---- Broadcast ---- */

typedef struct csp_broadcast_end csp_broadcast_end;

typedef struct csp_broadcast {
    csp_medium medium;
    csp_broadcast_end *ends; /* in the order in which they were made */
    csp_party *writer;       /* while not all ends have taken its value */
    csp_guard *outputs;
} csp_broadcast;

struct csp_broadcast_end {
    csp_medium medium;
    bool fresh;    /* has a value that was not taken */
    bool resolved; /* its alternative has the value already */
    csp_broadcast *channel;
    csp_broadcast_end *next;
    csp_party *reader;
    csp_guard *waiting; /* the guard of an alternative that waits, where the writer alternates */
    csp_guard *inputs;
};

csp_progress csp_broadcast_read(csp_party *party, csp_broadcast_end *end, void *value, size_t size);
csp_progress csp_broadcast_write(csp_party *party, csp_broadcast *channel, void *value, size_t size);

/* ---- Before the program starts ---- */

void csp_channel_init(csp_channel *channel, uint32_t number);
void csp_any_init(csp_any_channel *channel, uint32_t number);
void csp_buffer_init(csp_buffer *buffer, uint32_t number, void *values, uint32_t capacity, bool overwrites);
void csp_broadcast_init(csp_broadcast *channel, uint32_t number);
/* A reading end; the order of these calls is the order in which ends are served. */
void csp_broadcast_end_init(csp_broadcast_end *end, csp_broadcast *channel);

#endif
