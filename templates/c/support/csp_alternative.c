/* SPDX-License-Identifier: 0BSD */
/* The alternative: waits until a guard is ready, and chooses.
 *
 * If a guard is ready, it chooses immediately. Otherwise it waits: the first guard that becomes ready puts it into the ready queue. When it
 * runs, it chooses among the guards that are ready then; if none is ready any longer, it waits again.
 */
#include "csp_internal.h"

static inline csp_word bit_of(uint32_t index)
{
    return (csp_word)1U << (index % CSP_WORD_BITS);
}

/* The bits from `index` upwards. */
static inline csp_word bits_from(uint32_t index)
{
    return (index < CSP_WORD_BITS) ? (csp_word)(~(csp_word)0U << index) : (csp_word)0U;
}

bool csp_is_enabled(const csp_guard *guard)
{
    const csp_alternative *const alternative = guard->alternative;
    const csp_word word = csp_is_wide(alternative) ? alternative->more_enabled[guard->index / CSP_WORD_BITS]
                                                   : alternative->enabled;
    return (word & bit_of(guard->index)) != 0U;
}

static inline void wake(csp_kernel *csp, csp_alternative *alternative)
{
    if ((CSP_USES_INTERRUPTS != 0) && (alternative->interrupt != NULL)) {
        alternative->woken = true;
        csp_interrupt_wake(csp, alternative->interrupt);
    } else if (!alternative->woken) {
        alternative->woken = true;
        csp_ready(csp, alternative->process);
    } else {
        /* It is already in the ready queue. */
    }
}

void csp_raise_all(csp_kernel *csp, csp_guard *watchers)
{
    for (csp_guard *guard = watchers; guard != NULL; guard = guard->next) {
        csp_set_bit(guard);
        if (guard->alternative->armed && csp_is_enabled(guard)) {
            guard->alternative->armed = false;
            wake(csp, guard->alternative);
        }
    }
}

bool csp_awaited(const csp_guard *watchers)
{
    const csp_guard *guard = watchers;
    while ((guard != NULL) && !(guard->alternative->armed && csp_is_enabled(guard))) {
        guard = guard->next;
    }
    return guard != NULL;
}

/* The first guard that is enabled and ready, in an alternative of several words: of `first` only the guards in `bits`, then those of the following
 * words; `count` if there is none. */
static uint32_t first_of_words(const csp_alternative *alternative, uint32_t first, csp_word bits)
{
    uint32_t word = first;
    csp_word ready = alternative->more_ready[word] & alternative->more_enabled[word] & bits;
    csp_word words = alternative->ready & bits_from(word + 1U);
    while ((ready == 0U) && (words != 0U)) {
        word = csp_lowest_bit(words);
        words &= words - 1U;
        ready = alternative->more_ready[word] & alternative->more_enabled[word];
    }
    return (ready != 0U) ? ((word * CSP_WORD_BITS) + csp_lowest_bit(ready)) : alternative->count;
}

static void clear_time_outs(csp_kernel *csp, csp_alternative *alternative)
{
    if (CSP_USES_TIME_OUTS == 0) {
        return;
    }
    for (uint32_t index = 0U; index < alternative->count; index++) {
        csp_guard *const guard = &alternative->guard[index];
        if (guard->kind == (uint8_t)CSP_GUARD_AFTER) {
            (void)csp_timer_stop(csp, guard->at.timer);
            csp_clear_bit(guard);
        }
    }
}

bool csp_time_outs_passed(csp_alternative *alternative)
{
    bool passed = false;
    if (CSP_USES_TIME_OUTS == 0) {
        return false;
    }
    for (uint32_t index = 0U; index < alternative->count; index++) {
        csp_guard *const guard = &alternative->guard[index];
        if ((guard->kind == (uint8_t)CSP_GUARD_AFTER) && csp_is_enabled(guard) && (guard->at.timer->duration <= 0)) {
            csp_set_bit(guard);
            passed = true;
        }
    }
    return passed;
}

static void begin_time_outs(csp_kernel *csp, csp_alternative *alternative)
{
    if (CSP_USES_TIME_OUTS == 0) {
        return;
    }
    for (uint32_t index = 0U; index < alternative->count; index++) {
        csp_guard *const guard = &alternative->guard[index];
        if ((guard->kind == (uint8_t)CSP_GUARD_AFTER) && csp_is_enabled(guard)) {
            guard->at.timer->party = NULL;
            guard->at.timer->guard = guard;
            csp_timer_begin(csp, guard->at.timer, csp_after(csp, guard->at.timer->duration));
        }
    }
}

static void enroll_all(csp_kernel *csp, csp_alternative *alternative)
{
    for (uint32_t index = 0U; index < alternative->count; index++) {
        csp_guard *const guard = &alternative->guard[index];
        if (guard->attends && csp_is_enabled(guard) && !guard->is_enrolled) {
            csp_enroll(csp, guard);
        }
    }
}

static inline void begin_waiting(csp_kernel *csp, csp_party *party, csp_alternative *alternative)
{
    alternative->process = party;
    csp->begun++;
    alternative->began = csp->begun;
    alternative->waits = true;
    alternative->solved = false;
    alternative->woken = false;
    if (alternative->time_outs > 0U) {
        begin_time_outs(csp, alternative);
    }
    alternative->armed = true;
    if (alternative->attending > 0U) {
        enroll_all(csp, alternative);
    }
}

void csp_begin_waiting(csp_kernel *csp, csp_party *party, csp_alternative *alternative)
{
    begin_waiting(csp, party, alternative);
}

void csp_end_waiting(csp_kernel *csp, csp_alternative *alternative)
{
    alternative->waits = false;
    alternative->armed = false;
    if (alternative->time_outs > 0U) {
        clear_time_outs(csp, alternative);
    }
    if (alternative->enrolls) {
        for (uint32_t index = 0U; index < alternative->count; index++) {
            if (alternative->guard[index].is_enrolled) {
                csp_dismiss(&alternative->guard[index]);
            }
        }
        alternative->enrolls = false;
    }
}

void csp_resolve(csp_kernel *csp, csp_guard *guard)
{
    csp_alternative *const alternative = guard->alternative;
    csp_end_waiting(csp, alternative);
    alternative->chosen = guard->index;
    alternative->solved = true;
    wake(csp, alternative);
}

/* The promised value has been read: the process continues, but that of an interrupt only after its body has ended. */
static csp_party *redeem(csp_kernel *csp, csp_party *party)
{
    (void)csp;
    csp_alternative *const alternative = (csp_alternative *)(void *)((char *)party - offsetof(csp_alternative, pledge));
    alternative->pledged = false;
    if ((alternative->interrupt != NULL) && !csp_interrupt_waits(alternative->interrupt)) {
        return NULL;
    }
    return alternative->process;
}

csp_party *csp_pledge(csp_kernel *csp, csp_guard *guard)
{
    csp_alternative *const alternative = guard->alternative;
    csp_end_waiting(csp, alternative);
    alternative->chosen = guard->index;
    alternative->solved = true;
    alternative->pledged = true;
    alternative->pledge.step = redeem;
    alternative->pledge.level = alternative->process->level;
    alternative->pledge.number = alternative->process->number;
    if (alternative->interrupt != NULL) {
        wake(csp, alternative);
    }
    return &alternative->pledge;
}

bool csp_alternative_withdraw(csp_kernel *csp, csp_alternative *alternative, csp_party *party)
{
    if (csp_makes_offer(alternative)) {
        const bool waited = csp_withdraw(alternative->guard[alternative->chosen].medium, party);
        if (waited) {
            alternative->offers = false;
        }
        return waited;
    }
    if (csp_is_pledged(alternative)) {
        if (!csp_withdraw(alternative->guard[alternative->chosen].medium, &alternative->pledge)) {
            return false;
        }
        alternative->pledged = false;
        alternative->solved = false;
    } else if (!alternative->waits) {
        return false;
    } else {
        csp_end_waiting(csp, alternative);
    }
    return !alternative->woken;
}

static csp_progress communicate(csp_kernel *csp, csp_party *party, csp_alternative *alternative, csp_guard *guard)
{
    if (alternative->time_outs > 0U) {
        clear_time_outs(csp, alternative);
    }
    switch (guard->kind) {
    case CSP_GUARD_INPUT:
        return csp_take(csp, party, guard);
    case CSP_GUARD_READY:
        csp_settle_input(csp, guard);
        return CSP_DONE;
#if CSP_USES_OUTPUT_GUARDS
    case CSP_GUARD_OUTPUT: {
        const csp_progress progress = csp_choose_output(csp, party, guard);
        alternative->offers = progress == CSP_WAITS;
        return progress;
    }
#endif
    default:
        return CSP_DONE;
    }
}

csp_progress csp_communicate(csp_kernel *csp, csp_party *party, csp_alternative *alternative, csp_guard *guard)
{
    if ((alternative->quick != 0U) && (guard->kind == (uint8_t)CSP_GUARD_INPUT)) {
        return csp_take(csp, party, guard);
    }
    return communicate(csp, party, alternative, guard);
}

/* The next fair choice starts after the guard that was chosen last. */
static inline void remember(csp_alternative *alternative, uint32_t index)
{
    alternative->chosen = (uint16_t)index;
    if (!alternative->prioritized) {
        alternative->after = bits_from((index % CSP_WORD_BITS) + 1U);
        if (csp_is_wide(alternative)) {
            const uint32_t word = index / CSP_WORD_BITS;
            alternative->present_ready = &alternative->more_ready[word];
            alternative->present_enabled = &alternative->more_enabled[word];
            alternative->present_guard = &alternative->guard[word * CSP_WORD_BITS];
        }
    }
}

static inline uint32_t first_choice(const csp_alternative *alternative)
{
    if (!csp_is_wide(alternative)) {
        const csp_word ready = alternative->ready & alternative->enabled;
        const csp_word after = ready & alternative->after;
        return (ready == 0U) ? alternative->count : csp_lowest_bit((after != 0U) ? after : ready);
    }
    const uint32_t present = (uint32_t)(alternative->present_guard->index / CSP_WORD_BITS);
    const uint32_t index =
        alternative->prioritized ? alternative->count : first_of_words(alternative, present, alternative->after);
    return (index < alternative->count) ? index : first_of_words(alternative, 0U, ~(csp_word)0U);
}

static inline csp_progress choose(csp_kernel *csp, csp_party *party, csp_alternative *alternative, uint32_t index)
{
    remember(alternative, index);
    return csp_communicate(csp, party, alternative, &alternative->guard[index]);
}

csp_progress csp_select_any(csp_kernel *csp, csp_party *party, csp_alternative *alternative)
{
    if (csp_is_cancelled(party)) {
        return csp_refuse(csp, party);
    }
    if (alternative->time_outs > 0U) {
        (void)csp_time_outs_passed(alternative);
    }
    const uint32_t index = first_choice(alternative);
    if (index == alternative->count) {
        begin_waiting(csp, party, alternative);
        return CSP_WAITS;
    }
    return choose(csp, party, alternative, index);
}

csp_progress csp_select_again(csp_kernel *csp, csp_party *party, csp_alternative *alternative)
{
    if (csp_makes_offer(alternative)) {
        alternative->offers = false;
        return CSP_DONE;
    }
    alternative->woken = false;
    if (csp_is_pledged(alternative)) {
        return CSP_WAITS;
    }
    if (csp_is_solved(alternative)) {
        alternative->solved = false;
        remember(alternative, alternative->chosen);
        return CSP_DONE;
    }
    if (csp_is_cancelled(party)) {
        return csp_refuse(csp, party);
    }
    if ((CSP_SMALL == 0) && (csp_candidates(alternative) != 0U) && !alternative->enrolls) {
        alternative->waits = false;
        alternative->armed = false;
        return csp_select(csp, party, alternative);
    }
    const uint32_t index = first_choice(alternative);
    if (index == alternative->count) {
        alternative->armed = true;
        return CSP_WAITS;
    }
    csp_end_waiting(csp, alternative);
    return choose(csp, party, alternative, index);
}
