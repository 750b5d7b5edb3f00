/* SPDX-License-Identifier: 0BSD */
/* Alternatives and interrupts: waiting for one of several guards.
 *
 * Bit k of an alternative is set exactly while guard k is ready, whether or not the alternative waits. Whatever makes a guard
 * ready or unready sets or clears its bit, so a selection costs the same for ten guards as for a thousand.
 */
#ifndef CSP_ALTERNATIVE_H
#define CSP_ALTERNATIVE_H

#include "csp_core.h"
#include "csp_process.h"

#if UINTPTR_MAX > 0xFFFFFFFFU
typedef uint64_t csp_word;
#define CSP_WORD_BITS 64U
#else
typedef uint32_t csp_word;
#define CSP_WORD_BITS 32U
#endif

static inline uint32_t csp_lowest_bit(csp_word word)
{
#if defined(__GNUC__) && (UINTPTR_MAX > 0xFFFFFFFFU)
    return (uint32_t)__builtin_ctzll(word);
#elif defined(__GNUC__)
    return (uint32_t)__builtin_ctzl(word);
#else
    uint32_t bit = 0U;
    while (((word >> bit) & 1U) == 0U) {
        bit++;
    }
    return bit;
#endif
}

/* Two levels of words: 4096 guards on 64 bits, 1024 on 32. */
#define CSP_GUARDS_MAX (CSP_WORD_BITS * CSP_WORD_BITS)

typedef enum csp_guard_kind {
    CSP_GUARD_INPUT,    /* reads into `slot` */
    CSP_GUARD_READY,    /* the guarded process begins by reading */
    CSP_GUARD_OUTPUT,   /* writes from `slot` */
    CSP_GUARD_AFTER,
    CSP_GUARD_SKIP /* also for communications that never wait (variables, constants, outputs to the outside), which generated code makes itself */
} csp_guard_kind;

struct csp_guard {
    csp_guard *next; /* the next guard that watches the same channel */
    csp_alternative *alternative;
    csp_word *word; /* the word of the alternative with the bit of this guard */
    csp_word bit;
    csp_medium *medium;
    union {
        void *slot;       /* of a communication */
        csp_timer *timer; /* of a time-out */
    } at;
    uint32_t size; /* of the value */
    uint16_t index;
    uint8_t kind;         /* csp_guard_kind */
    bool direct : 1;      /* reads on a csp_guarded_channel that no other guard watches: while it is ready, the writer waits there */
    bool attends : 1;     /* the channel has to be notified when the alternative waits */
    bool is_enrolled : 1;
    csp_guard *enrolled;  /* of a communication: the next guard that waits there, if alternatives are on both sides */
};

/* Up to this number of guards an alternative has no words of its own, on any machine. */
#define CSP_GUARDS_OF_WORD 32U
/* The words of an alternative of more guards, CSP_WORDS(count) each. */
#define CSP_WORDS(count) (((count) + CSP_WORD_BITS - 1U) / CSP_WORD_BITS)

/* Flags come first, as in csp_kernel. */
struct csp_alternative {
    bool prioritized;
    bool waits;  /* registered */
    bool enrolls; /* some guards are enrolled */
    bool armed;  /* the first guard that becomes ready will wake it */
    bool woken;  /* a guard has become ready, and the process is in the ready queue */
    bool solved; /* the other side has chosen */
    bool offers; /* the process has chosen to write, and waits until the reader, which has only been promised the value, reads it */
    bool pledged;     /* the same, but the reader has chosen: */
    uint16_t count;
    uint16_t chosen;     /* the guard */
    uint16_t time_outs;  /* number of guards with `after` */
    uint16_t attending;  /* number of guards that attend */
    csp_word ready;   /* bits of the guards, or of the non-zero words of `more_ready` */
    csp_word enabled; /* bits of the guards; not used with several words */
    csp_word after;   /* bits of the guards after the one that was chosen last, in the present word */
    csp_word fair;    /* all bits, or none: prioritized */
    csp_word quick;   /* all bits, or none: time-outs */
    csp_word around;  /* all bits, or none: several words */
    /* The present word, with the guard that was chosen last: bits of ready and of enabled guards, and the guard of its lowest bit. */
    csp_word *present_ready;
    const csp_word *present_enabled;
    csp_guard *present_guard;
    csp_word *more_ready;
    csp_word *more_enabled;
    csp_guard *guard;
    csp_party *process; /* while it waits */
    uint32_t began;     /* number of the wait: alternatives are numbered in the order in which they began to wait */
    csp_party pledge; /* the party that waits in the channel, if it is pledged */
    struct csp_interrupt *interrupt; /* the interrupt whose guard this is, or NULL */
};

/* Whether it has several words. */
static inline bool csp_is_wide(const csp_alternative *alternative)
{
    return (CSP_USES_WIDE_ALTERNATIVES != 0) && (alternative->around == 0U);
}

/* Whether the other side has chosen the guard, */
static inline bool csp_is_solved(const csp_alternative *alternative)
{
    return (CSP_USES_CHOSEN_GUARDS != 0) && alternative->solved;
}

/* and is going to read the value that it was promised. */
static inline bool csp_is_pledged(const csp_alternative *alternative)
{
    return (CSP_USES_CHOSEN_GUARDS != 0) && alternative->pledged;
}

/* Whether the process has chosen to write, and waits for that. */
static inline bool csp_makes_offer(const csp_alternative *alternative)
{
    return (CSP_USES_OUTPUT_GUARDS != 0) && alternative->offers;
}

/* The bit of the guard's word in the set of words that are not zero. */
static inline csp_word csp_bit_of_word(const csp_guard *guard)
{
    return (csp_word)1U << (guard->index / CSP_WORD_BITS);
}

static inline void csp_set_bit(const csp_guard *guard)
{
    *guard->word |= guard->bit;
    if (csp_is_wide(guard->alternative)) {
        guard->alternative->ready |= csp_bit_of_word(guard);
    }
}

static inline void csp_clear_bit(const csp_guard *guard)
{
    *guard->word &= ~guard->bit;
    if (csp_is_wide(guard->alternative) && (*guard->word == 0U)) {
        guard->alternative->ready &= ~csp_bit_of_word(guard);
    }
}

/* To be called when guards have become ready: wakes the alternatives that wait for them. */
void csp_raise_all(csp_kernel *csp, csp_guard *watchers);

static inline void csp_raise_bits(csp_kernel *csp, csp_guard *watchers)
{
    if (watchers != NULL) {
        if ((watchers->next == NULL) && !watchers->alternative->armed) {
            csp_set_bit(watchers);
        } else {
            csp_raise_all(csp, watchers);
        }
    }
}

static inline void csp_lower_bits(csp_guard *watchers)
{
    for (csp_guard *guard = watchers; guard != NULL; guard = guard->next) {
        csp_clear_bit(guard);
    }
}

/* ---- Before the program starts, in the order of ProcessClass.creation ---- */

/* `words` has 2 * CSP_WORDS(count) words, or is NULL for up to CSP_WORD_BITS guards. */
void csp_alternative_init(csp_alternative *alternative, csp_guard *guard, uint16_t count, csp_word *words,
                          bool prioritized);
/* One call for every guard; the duration of a time-out is set after it. `medium` is that of a csp_guarded_channel, csp_any_channel, csp_buffer, csp_broadcast or of a reading end. */
void csp_guard_read(csp_alternative *alternative, uint32_t index, csp_medium *medium, void *value, size_t size);
void csp_guard_ready(csp_alternative *alternative, uint32_t index, csp_medium *medium);
void csp_guard_write(csp_alternative *alternative, uint32_t index, csp_medium *medium, void *value, size_t size);
void csp_guard_after(csp_alternative *alternative, uint32_t index, csp_timer *timer);
void csp_guard_skip(csp_alternative *alternative, uint32_t index);

/* ---- Selection ---- */

/* Sets which guards may be chosen: all, or none and then some. Before that, values of output guards are stored where csp_guard_write said, and
 * the durations of time-outs are set. */
void csp_enable_all(csp_alternative *alternative);
void csp_enable_none(csp_alternative *alternative);
void csp_enable(csp_alternative *alternative, uint32_t index);
static inline void csp_delay(csp_alternative *alternative, uint32_t index, int64_t duration)
{
    alternative->guard[index].at.timer->duration = duration;
}

/* CSP_AWAIT(csp_select(party, a), csp_select_again(party, a), ...): afterwards `a->chosen` is the index of the guard, and its communication has
 * taken place. */
static inline csp_progress csp_select(csp_kernel *csp, csp_party *party, csp_alternative *alternative);
/* The same where each of the `count` guards reads and none has a condition, and the choice is fair. */
static inline csp_progress csp_select_inputs(csp_kernel *csp, csp_party *party, csp_alternative *alternative, uint32_t count);
csp_progress csp_select_again(csp_kernel *csp, csp_party *party, csp_alternative *alternative);

/* ---- Interrupt ---- */

typedef struct csp_interrupt {
    bool body_ended;
    bool communicates;
    bool taken; /* whether the handler runs */
    csp_process *victim;
    csp_alternative alternative; /* its only guard */
    csp_guard guard;
    csp_timer timer;
    csp_party canceller; /* ends the body if the body itself has made the guard ready */
    csp_branches branch;
    csp_parallel body; /* its only branch */
} csp_interrupt;

/* `body` is the offset of the body's csp_process in the struct. The guard is set up by csp_guard_... with &interrupt->alternative and index 0, each time just
 * before: */
void csp_interrupt_init(csp_interrupt *interrupt, uint32_t body);
void csp_interrupt_prepare(csp_interrupt *interrupt);

/* CSP_AWAIT(csp_interruptible(party, i), csp_interruptible_again(party, i), ...): afterwards, if `i->taken`, the branch of the guard is run. */
csp_progress csp_interruptible(csp_kernel *csp, csp_party *party, csp_interrupt *interrupt);
csp_progress csp_interruptible_again(csp_kernel *csp, csp_party *party, csp_interrupt *interrupt);

#endif
