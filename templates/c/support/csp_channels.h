/* Channels in guards or with several users, channels with memory, and broadcast channels. */
#ifndef CSP_CHANNELS_H
#define CSP_CHANNELS_H

#include "csp_alternative.h"
#include "csp_core.h"

/* For all operations: `party` is that of the process or of the csp_offer; the result is CSP_DONE or CSP_WAITS. A process first checks
 * csp_is_cancelled (the macro CSP_COMMUNICATE does), and after CSP_WAITS the operation is complete when it runs again. `value` is the variable
 * to read into or to write from; it must exist as long as the process waits. */

/* ---- Rendezvous: `any`, and `sync` channels with guards ---- */

typedef struct csp_any_channel {
    csp_medium medium;
    csp_queue readers; /* at most one of the two queues is not empty */
    csp_queue writers;
    csp_guard *inputs;  /* guards that watch for a writer or a reader */
    csp_guard *outputs;
    csp_guard *reading; /* guards of waiting alternatives, if alternatives are on both sides */
    csp_guard *writing;
} csp_any_channel;

/* Takes the party that has waited longest out of a queue that is not empty. */
static inline csp_party *csp_leave(csp_queue *queue)
{
    csp_party *const party = queue->first;
    queue->first = party->next;
    return party;
}

/* Communicates with the first waiting writer or reader. */
static inline void csp_any_from_writer(const csp_party *party, csp_any_channel *channel, void *value, size_t size)
{
    csp_party *const writer = csp_leave(&channel->writers);
    if ((channel->writers.first == NULL) && (channel->writing == NULL)) {
        csp_lower_bits(channel->inputs);
    }
    csp_copy(value, writer->slot, size);
    csp_ready(writer);
    csp_observe(channel->medium.number, value, writer->number, party->number);
}

static inline void csp_any_to_reader(const csp_party *party, csp_any_channel *channel, const void *value, size_t size)
{
    csp_party *const reader = csp_leave(&channel->readers);
    if ((channel->readers.first == NULL) && (channel->reading == NULL)) {
        csp_lower_bits(channel->outputs);
    }
    csp_copy(reader->slot, value, size);
    csp_ready(reader);
    csp_observe(channel->medium.number, value, party->number, reader->number);
}

static inline csp_progress csp_any_read(csp_party *party, csp_any_channel *channel, void *value, size_t size)
{
    if (channel->writers.first != NULL) {
        csp_any_from_writer(party, channel, value, size);
        return CSP_DONE;
    }
    party->slot = value;
    csp_enter(&channel->readers, party);
    csp_raise_bits(channel->outputs);
    return CSP_WAITS;
}

static inline csp_progress csp_any_write(csp_party *party, csp_any_channel *channel, void *value, size_t size)
{
    if (channel->readers.first != NULL) {
        csp_any_to_reader(party, channel, value, size);
        return CSP_DONE;
    }
    party->slot = value;
    csp_enter(&channel->writers, party);
    csp_raise_bits(channel->inputs);
    return CSP_WAITS;
}

/* ---- Selection (csp_alternative.h) ---- */

/* The general case of csp_select, and the communication of a guard that is ready. */
csp_progress csp_select_any(csp_party *party, csp_alternative *alternative);
csp_progress csp_choose(csp_party *party, csp_alternative *alternative, uint32_t index);

/* The common case inline: a guard of the present word reads from a waiting writer. */
static inline csp_progress csp_select(csp_party *party, csp_alternative *alternative)
{
    const csp_word ready = *alternative->present_ready & *alternative->present_enabled & alternative->quick;
    const csp_word after = ready & alternative->after;
    const csp_word candidates = (after != 0U) ? after : (ready & alternative->around);
    if ((candidates == 0U) || csp_is_cancelled(party)) {
        return csp_select_any(party, alternative);
    }
    const csp_word bit = candidates & (csp_word)(0U - candidates);
    csp_guard *const guard = &alternative->present_guard[csp_lowest_bit(bit)];
    if (!guard->direct) {
        return csp_choose(party, alternative, guard->index);
    }
    csp_any_channel *const channel = (csp_any_channel *)(void *)guard->medium;
    csp_party *const writer = csp_leave(&channel->writers);
    alternative->after = (csp_word)(0U - (bit << 1U)) & alternative->fair;
    alternative->chosen = guard->index;
    if (channel->writers.first == NULL) {
        const csp_word others = *alternative->present_ready & ~bit;
        *alternative->present_ready = others;
        if ((others == 0U) && (alternative->around == 0U)) {
            alternative->ready &= ~csp_bit_of_word(guard);
        }
    }
    csp_copy(guard->slot, writer->slot, guard->size);
    csp_ready(writer);
    csp_observe(channel->medium.number, guard->slot, writer->number, party->number);
    return CSP_DONE;
}

/* ---- Memory ---- */

typedef struct csp_buffer {
    csp_medium medium;
    bool overwrites; /* a write to a full buffer overwrites the oldest value */
    uint32_t capacity;
    uint32_t stored;
    uint32_t first;
    unsigned char *values; /* capacity * size bytes */
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
    csp_broadcast_end *ends; /* in the order of their initialization */
    csp_party *writer;       /* waits until all ends have taken its value */
    csp_guard *outputs;
} csp_broadcast;

struct csp_broadcast_end {
    csp_medium medium;
    bool fresh;    /* has a value that has not been taken */
    bool resolved; /* its alternative already has the value */
    csp_broadcast *channel;
    csp_broadcast_end *next;
    csp_party *reader;
    csp_guard *waiting; /* the guard of a waiting alternative, if the writer is an alternative, too */
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
