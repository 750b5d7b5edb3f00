/* SPDX-License-Identifier: 0BSD */
/* Channels in guards or with several users, channels with memory, and broadcast channels. */
#ifndef CSP_CHANNELS_H
#define CSP_CHANNELS_H

#include "csp_alternative.h"
#include "csp_core.h"

/* For all operations: `party` is that of the process or of the csp_offer; the result is CSP_DONE or CSP_WAITS. A process first checks
 * csp_refused, and after CSP_WAITS the operation is complete when it runs again. `value` is the variable
 * to read into or to write from; it must exist as long as the process waits. */

/* ---- Rendezvous: `sync` channels with guards of the reader only ---- */

/* As it has one writer and one reader, at most one of them waits, and no alternative ever decides for another. */
typedef struct csp_guarded_channel {
    csp_channel channel;
    csp_guard *inputs; /* guards that watch for the writer */
    csp_guard *sole;   /* the only one of them; NULL: there are several, or none */
} csp_guarded_channel;

static inline csp_progress csp_guarded_read(csp_kernel *csp, csp_party *party, csp_guarded_channel *channel, void *value, size_t size)
{
    const csp_progress progress = csp_channel_read(csp, party, &channel->channel, value, size);
    if (progress == CSP_DONE) {
        csp_lower_bits(channel->inputs);
    }
    return progress;
}

static inline csp_progress csp_guarded_write(csp_kernel *csp, csp_party *party, csp_guarded_channel *channel, void *value, size_t size)
{
    const csp_progress progress = csp_channel_write(csp, party, &channel->channel, value, size);
    if (progress == CSP_WAITS) {
        if ((channel->sole == NULL) || channel->sole->alternative->armed) {
            csp_raise_all(csp, channel->inputs);
        } else {
            csp_set_bit(channel->sole);
        }
    }
    return progress;
}

/* ---- Rendezvous: `any`, and `sync` channels with guards of the writer ---- */

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
static inline void csp_any_from_writer(csp_kernel *csp, const csp_party *party, csp_any_channel *channel, void *value, size_t size)
{
    csp_party *const writer = csp_leave(&channel->writers);
    if ((channel->writers.first == NULL) && (channel->writing == NULL)) {
        csp_lower_bits(channel->inputs);
    }
    csp_copy(value, writer->slot, size);
    csp_ready(csp, writer);
    csp_observe(csp, channel->medium.number, value, writer->number, party->number);
}

static inline void csp_any_to_reader(csp_kernel *csp, const csp_party *party, csp_any_channel *channel, const void *value, size_t size)
{
    csp_party *const reader = csp_leave(&channel->readers);
    if ((channel->readers.first == NULL) && (channel->reading == NULL)) {
        csp_lower_bits(channel->outputs);
    }
    csp_copy(reader->slot, value, size);
    csp_ready(csp, reader);
    csp_observe(csp, channel->medium.number, value, party->number, reader->number);
}

static inline csp_progress csp_any_read(csp_kernel *csp, csp_party *party, csp_any_channel *channel, void *value, size_t size)
{
    if (channel->writers.first != NULL) {
        csp_any_from_writer(csp, party, channel, value, size);
        return CSP_DONE;
    }
    party->slot = value;
    csp_enter(&channel->readers, party);
    csp_raise_bits(csp, channel->outputs);
    return CSP_WAITS;
}

static inline csp_progress csp_any_write(csp_kernel *csp, csp_party *party, csp_any_channel *channel, void *value, size_t size)
{
    if (channel->readers.first != NULL) {
        csp_any_to_reader(csp, party, channel, value, size);
        return CSP_DONE;
    }
    party->slot = value;
    csp_enter(&channel->writers, party);
    csp_raise_bits(csp, channel->inputs);
    return CSP_WAITS;
}

/* ---- Selection (csp_alternative.h) ---- */

/* The general case of csp_select, and the communication of a guard that is ready. */
csp_progress csp_select_any(csp_kernel *csp, csp_party *party, csp_alternative *alternative);
csp_progress csp_communicate(csp_kernel *csp, csp_party *party, csp_alternative *alternative, csp_guard *guard);

/* The ready guards of the present word from which a selection without time-outs may choose. */
static inline csp_word csp_candidates(const csp_alternative *alternative)
{
    const csp_word present = (CSP_USES_WIDE_ALTERNATIVES != 0) ? (*alternative->present_ready & *alternative->present_enabled)
                                                               : (alternative->ready & alternative->enabled);
    const csp_word ready = present & alternative->quick;
    const csp_word after = ready & alternative->after;
    return (after != 0U) ? after : (ready & ((CSP_USES_WIDE_ALTERNATIVES != 0) ? alternative->around : ready));
}

static inline void csp_remember(csp_alternative *alternative, const csp_guard *chosen, csp_word after)
{
    alternative->chosen = chosen->index;
    alternative->after = after;
}

/* The common case inline: a guard of a word reads on a channel of its own. `guards` has the guards of the word, `several` says whether there are more words. */
static inline csp_progress csp_select_in(csp_kernel *csp, csp_party *party, csp_alternative *alternative, csp_word candidates,
                                         csp_word *word, csp_guard *guards, csp_word fair, bool several)
{
    if ((candidates == 0U) || csp_is_cancelled(party)) {
        return csp_select_any(csp, party, alternative);
    }
    csp_guard *const guard = &guards[csp_lowest_bit(candidates)];
    const csp_word up_to_chosen = candidates ^ (candidates - 1U);
    if (!guard->direct) {
        csp_remember(alternative, guard, ~up_to_chosen & fair);
        return csp_communicate(csp, party, alternative, guard);
    }
    const csp_word others = *word ^ (up_to_chosen & candidates);
    *word = others;
    if (several && (others == 0U)) {
        alternative->ready &= ~csp_bit_of_word(guard);
    }
    csp_remember(alternative, guard, ~up_to_chosen & fair);
    csp_channel_take(csp, party, &((csp_guarded_channel *)(void *)guard->medium)->channel, guard->at.slot, guard->size);
    return CSP_DONE;
}

static inline csp_progress csp_select(csp_kernel *csp, csp_party *party, csp_alternative *alternative)
{
    if (CSP_SMALL != 0) {
        return csp_select_any(csp, party, alternative);
    }
    return csp_select_in(csp, party, alternative, csp_candidates(alternative), alternative->present_ready,
                         alternative->present_guard, alternative->fair, csp_is_wide(alternative));
}

static inline csp_progress csp_select_inputs(csp_kernel *csp, csp_party *party, csp_alternative *alternative, uint32_t count)
{
    if (CSP_SMALL != 0) {
        return csp_select_any(csp, party, alternative);
    }
    if (count > CSP_GUARDS_OF_WORD) {
        return csp_select_in(csp, party, alternative, *alternative->present_ready & alternative->after,
                             alternative->present_ready, alternative->present_guard, ~(csp_word)0U, true);
    }
    const csp_word after = alternative->ready & alternative->after;
    return csp_select_in(csp, party, alternative, (after != 0U) ? after : alternative->ready, &alternative->ready,
                         alternative->guard, ~(csp_word)0U, false);
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

csp_progress csp_buffer_read(csp_kernel *csp, csp_party *party, csp_buffer *buffer, void *value, size_t size);
csp_progress csp_buffer_write(csp_kernel *csp, csp_party *party, csp_buffer *buffer, void *value, size_t size);

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

csp_progress csp_broadcast_read(csp_kernel *csp, csp_party *party, csp_broadcast_end *end, void *value, size_t size);
csp_progress csp_broadcast_write(csp_kernel *csp, csp_party *party, csp_broadcast *channel, void *value, size_t size);

/* ---- Before the program starts ---- */

void csp_channel_init(csp_channel *channel, uint32_t number);
void csp_guarded_init(csp_guarded_channel *channel, uint32_t number);
void csp_any_init(csp_any_channel *channel, uint32_t number);
void csp_buffer_init(csp_buffer *buffer, uint32_t number, void *values, uint32_t capacity, bool overwrites);
void csp_broadcast_init(csp_broadcast *channel, uint32_t number);
/* A reading end; the order of these calls is the order in which ends are served. */
void csp_broadcast_end_init(csp_broadcast_end *end, csp_broadcast *channel);

#endif
