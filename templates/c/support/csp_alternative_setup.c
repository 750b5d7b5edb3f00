/* SPDX-License-Identifier: 0BSD */
/* Initialization of alternatives, and which of their guards are enabled. */
#include "csp_internal.h"

static csp_word bit_of(uint32_t index)
{
    return (csp_word)1U << (index % CSP_WORD_BITS);
}

void csp_alternative_init(csp_alternative *alternative, csp_guard *guard, uint16_t count, csp_word *words,
                          bool prioritized)
{
    const bool wide = (CSP_USES_WIDE_ALTERNATIVES != 0) && (words != NULL);
    alternative->guard = guard;
    alternative->count = count;
    alternative->prioritized = prioritized;
    alternative->fair = prioritized ? 0U : ~(csp_word)0U;
    alternative->after = alternative->fair;
    alternative->quick = ~(csp_word)0U;
    alternative->around = wide ? 0U : ~(csp_word)0U;
    alternative->more_ready = words;
    alternative->more_enabled = wide ? &words[CSP_WORDS(count)] : NULL;
    alternative->present_ready = wide ? alternative->more_ready : &alternative->ready;
    alternative->present_enabled = wide ? alternative->more_enabled : &alternative->enabled;
    alternative->present_guard = guard;
    for (uint16_t index = 0U; index < count; index++) {
        guard[index].alternative = alternative;
        guard[index].index = index;
        guard[index].bit = bit_of(index);
        guard[index].word = wide ? &words[index / CSP_WORD_BITS] : &alternative->ready;
    }
}

void csp_guard_read(csp_alternative *alternative, uint32_t index, csp_medium *medium, void *value, size_t size)
{
    csp_guard *const guard = &alternative->guard[index];
    guard->kind = (uint8_t)CSP_GUARD_INPUT;
    guard->medium = medium;
    guard->at.slot = value;
    guard->size = (uint32_t)size;
    csp_watch_input(NULL, guard);
}

void csp_guard_ready(csp_alternative *alternative, uint32_t index, csp_medium *medium)
{
    csp_guard *const guard = &alternative->guard[index];
    guard->kind = (uint8_t)CSP_GUARD_READY;
    guard->medium = medium;
    csp_watch_input(NULL, guard);
}

void csp_guard_write(csp_alternative *alternative, uint32_t index, csp_medium *medium, void *value, size_t size)
{
    csp_guard *const guard = &alternative->guard[index];
    guard->kind = (uint8_t)CSP_GUARD_OUTPUT;
    guard->medium = medium;
    guard->at.slot = value;
    guard->size = (uint32_t)size;
    csp_watch_output(NULL, guard);
}

void csp_guard_after(csp_alternative *alternative, uint32_t index, csp_timer *timer)
{
    csp_guard *const guard = &alternative->guard[index];
    guard->kind = (uint8_t)CSP_GUARD_AFTER;
    guard->next = NULL;
    guard->medium = NULL;
    guard->at.timer = timer;
    alternative->time_outs++;
    alternative->quick = 0U;
}

void csp_guard_skip(csp_alternative *alternative, uint32_t index)
{
    csp_guard *const guard = &alternative->guard[index];
    guard->kind = (uint8_t)CSP_GUARD_SKIP;
    guard->medium = NULL;
    csp_set_bit(guard);
}

void csp_enable_all(csp_alternative *alternative)
{
    alternative->enabled = ~(csp_word)0U;
    if (csp_is_wide(alternative)) {
        for (uint32_t word = 0U; word < CSP_WORDS(alternative->count); word++) {
            alternative->more_enabled[word] = ~(csp_word)0U;
        }
    }
}

void csp_enable_none(csp_alternative *alternative)
{
    alternative->enabled = 0U;
    if (csp_is_wide(alternative)) {
        for (uint32_t word = 0U; word < CSP_WORDS(alternative->count); word++) {
            alternative->more_enabled[word] = 0U;
        }
    }
}

void csp_enable(csp_alternative *alternative, uint32_t index)
{
    if (csp_is_wide(alternative)) {
        alternative->more_enabled[index / CSP_WORD_BITS] |= bit_of(index);
    } else {
        alternative->enabled |= bit_of(index);
    }
}
