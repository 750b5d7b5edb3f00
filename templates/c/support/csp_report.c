/* SPDX-License-Identifier: 0BSD */
/* Texts for users: which processes wait for which, and why a run has failed. */
#include "csp_internal.h"
#include "csp_shared.h"
#include "csp_text.h"

/* Appends a duration as "1.5 ms", exact to the nanosecond. */
static void append_duration(int64_t duration, char *text, size_t size)
{
    static const struct {
        int64_t unit;
        const char *name;
    } units[] = {{INT64_C(1000000000), " s"}, {INT64_C(1000000), " ms"}, {INT64_C(1000), " us"}, {1, " ns"}};
    const uint64_t length = (duration < 0) ? (uint64_t)0 - (uint64_t)duration : (uint64_t)duration;
    size_t index = 0U;
    while ((index < 3U) && (length < (uint64_t)units[index].unit)) {
        index++;
    }
    uint64_t rest = length % (uint64_t)units[index].unit;
    csp_append(text, size, (duration < 0) ? "-" : "");
    csp_append_digits(text, size, length / (uint64_t)units[index].unit, 1);
    if (rest > 0U) {
        int digits = 9 - (3 * (int)index);
        while ((rest % 10U) == 0U) {
            rest /= 10U;
            digits--;
        }
        csp_append(text, size, ".");
        csp_append_digits(text, size, rest, digits);
    }
    csp_append(text, size, units[index].name);
}

static void append_channel(csp_kernel *csp, uint32_t channel, char *text, size_t size)
{
    const size_t length = strlen(text);
    if (csp->program->channel_name != NULL) {
        csp->program->channel_name(channel, &text[length], size - length);
    } else if ((channel < csp->program->port_count) && (csp->program->ports[channel].name != NULL)) {
        csp_append(text, size, csp->program->ports[channel].name);
    } else {
        csp_append(text, size, "channel ");
        csp_append_digits(text, size, channel, 1);
    }
}

static void append_process(csp_kernel *csp, const csp_process *process, const char *inner, char *text,
                           size_t size)
{
    const size_t length = strlen(text);
    if (csp->program->process_name != NULL) {
        csp->program->process_name(process->party.number, &text[length], size - length);
    } else {
        csp_append(text, size, process->kind->name);
    }
    if (inner != NULL) {
        csp_append(text, size, ".");
        csp_append(text, size, inner);
    }
}

static void append_entry(csp_kernel *csp, const csp_wait_entry *entry, char *text, size_t size)
{
    csp_append(text, size, entry->words);
    if (entry->duration != 0) {
        csp_append(text, size, " ");
        append_duration(entry->duration, text, size);
    }
    if (entry->named) {
        csp_append(text, size, " ");
        append_channel(csp, entry->channel, text, size);
    }
}

static void append_place(const char *where, char *text, size_t size)
{
    if (where != NULL) {
        csp_append(text, size, " (");
        csp_append(text, size, where);
        csp_append(text, size, ")");
    }
}

static bool is_repeated(const csp_waiting_process *waiting, uint32_t count, const csp_wait_entry *entry)
{
    csp_wait_entry earlier = {"", false, 0U, 0, NULL};
    bool repeated = false;
    for (uint32_t index = 0U; (index < count) && !repeated; index++) {
        (void)csp_wait_of(waiting, index, &earlier);
        repeated = (strcmp(earlier.words, entry->words) == 0) && (earlier.named == entry->named) &&
               (earlier.channel == entry->channel) && (earlier.duration == entry->duration);
    }
    return repeated;
}

void csp_describe_waiting(csp_kernel *csp, const csp_waiting_process *waiting, char *text, size_t size)
{
    csp_wait_entry entry = {"", false, 0U, 0, NULL};
    text[0] = '\0';
    append_process(csp, waiting->process, waiting->place->inner, text, size);
    csp_append(text, size, " waits ");
    for (uint32_t index = 0U; csp_wait_of(waiting, index, &entry); index++) {
        if (is_repeated(waiting, index, &entry)) {
            continue;
        }
        if (index > 0U) {
            csp_append(text, size, " or ");
        }
        append_entry(csp, &entry, text, size);
    }
    append_place((waiting->place->where != NULL) ? waiting->place->where : waiting->process->kind->where, text, size);
}

void csp_describe_message(csp_kernel *csp, char *text, size_t size)
{
    text[0] = '\0';
    if (csp->error.describe != NULL) {
        csp->error.describe(&csp->error.operands, text, size);
    } else if (csp->error.exception == (uint16_t)CSP_TIMEOUT_EXCEPTION) {
        csp_append(text, size, "a sample of ");
        append_channel(csp, (uint32_t)csp->error.operands.integers[0], text, size);
        csp_append(text, size, " was overwritten before it had been taken");
    } else {
        /* The name of the exception is the message. */
    }
}

const char *csp_exception_name(csp_kernel *csp)
{
    switch (csp->error.exception) {
    case CSP_NO_EXCEPTION:
        return "";
    case CSP_CANCELLATION:
        return "Cancelled";
    case CSP_FAULT_EXCEPTION:
        return "Fault";
    case CSP_TIMEOUT_EXCEPTION:
        return "Timeout";
    default:
        return csp->program->exception_names[csp->error.exception - (uint16_t)CSP_FIRST_EXCEPTION];
    }
}

void csp_describe_place(csp_kernel *csp, char *text, size_t size)
{
    text[0] = '\0';
    if (csp->error.process != NULL) {
        append_process(csp, csp->error.process, csp->error.inner, text, size);
        if (csp->error.law != NULL) {
            csp_append(text, size, ".");
            csp_append(text, size, csp->error.law);
        }
        append_place((csp->error.place != NULL) ? csp->error.place : csp->error.process->kind->where, text, size);
    }
}

void csp_describe_error(csp_kernel *csp, char *text, size_t size)
{
    text[0] = '\0';
    csp_append(text, size, csp_exception_name(csp));
    const size_t named = strlen(text);
    csp_append(text, size, ": ");
    const size_t introduced = strlen(text);
    csp_describe_message(csp, &text[introduced], size - introduced);
    if (((introduced + 1U) < size) && (text[introduced] == '\0')) {
        text[named] = '\0';
    }
    if (csp->error.process != NULL) {
        csp_append(text, size, ", in ");
        csp_describe_place(csp, &text[strlen(text)], size - strlen(text));
    }
}

/* The process that is running, as another thread sees it; NULL: none. */
static const csp_process *present_process(csp_kernel *csp)
{
    const csp_party *const party = CSP_LOAD(csp->current);
    if ((party != NULL) && ((party->flags & (unsigned)CSP_OFFERED) != 0U)) {
        return (const csp_process *)(const void *)((const csp_offer *)(const void *)party)->offers->process;
    }
    return (const csp_process *)(const void *)party;
}

/* Appends where a process is, given the place where it last waited. */
static void append_whereabouts(csp_kernel *csp, const csp_place *place, char *text, size_t size)
{
#if CSP_TRACE
    const char *const loop = csp->loop;
    if (loop != NULL) {
        append_place(loop, text, size);
        return;
    }
#else
    (void)csp;
#endif
    const bool waited = place->waiting != (uint8_t)CSP_AT_NOTHING;
    csp_append(text, size, waited ? " (last waited at " : " (");
    csp_append(text, size, place->where);
    csp_append(text, size, ")");
}

void csp_describe_at_work(csp_kernel *csp, char *text, size_t size)
{
    text[0] = '\0';
    if (csp_is_driving(csp)) {
        csp_describe_current(csp, text, size);
    }
}

void csp_describe_current(csp_kernel *csp, char *text, size_t size)
{
    const csp_process *const process = present_process(csp);
    text[0] = '\0';
    if (process == NULL) {
        return;
    }
    const csp_place *const place = csp_place_of(process);
    append_process(csp, process, place->inner, text, size);
    append_whereabouts(csp, place, text, size);
}

void csp_describe_interrupted(csp_kernel *csp, char *text, size_t size)
{
    const csp_calls calls = csp_calls_now(csp);
    text[0] = '\0';
    if (!calls.driving) {
        /* There is nothing to describe. */
    } else if (calls.port != NULL) {
        csp_append(text, size, calls.releases ? "the safe value of " : "the device function of ");
        append_channel(csp, calls.port->number, text, size);
    } else if (present_process(csp) != NULL) {
        csp_describe_current(csp, text, size);
    } else if (csp->program->environment != NULL) {
        csp_append(text, size, "the environment");
    } else {
        /* It happened between two steps. */
    }
}

/* The state is read while it may change, so a process is described by what changes least. */
void csp_describe_present(csp_kernel *csp, char *text, size_t size)
{
    const csp_calls calls = csp_calls_now(csp);
    const csp_process *const process = calls.driving ? present_process(csp) : NULL;
    text[0] = '\0';
    if (!calls.driving) {
        csp_append(text, size, "nothing runs");
    } else if (calls.port != NULL) {
        csp_append(text, size, calls.releases ? "" : "the device function of ");
        append_channel(csp, calls.port->number, text, size);
        csp_append(text, size, calls.releases ? " does not take its safe value" : " has not returned");
    } else if (process != NULL) {
        append_process(csp, process, csp_place_of(process)->inner, text, size);
        append_place(csp_place_of(process)->where, text, size);
        csp_append(text, size, " has not reached its next communication");
    } else {
        csp_append(text, size, "the program has not continued");
    }
}

void csp_describe_missed(csp_kernel *csp, char *text, size_t size)
{
    text[0] = '\0';
    for (uint32_t index = 0U; index < csp->program->port_count; index++) {
        const csp_medium *const medium = csp_medium_of(csp, &csp->program->ports[index]);
        const uint32_t missed = (csp->program->ports[index].kind == CSP_PORT_SAMPLED)
                                    ? ((const csp_sampled_input *)(const void *)medium)->missed
                                    : 0U;
        if (missed > 0U) {
            csp_append(text, size, (text[0] == '\0') ? "" : ", ");
            append_channel(csp, medium->number, text, size);
            csp_append(text, size, " ");
            csp_append_digits(text, size, missed, 1);
        }
    }
    if (text[0] == '\0') {
        csp_append(text, size, "none");
    }
}
