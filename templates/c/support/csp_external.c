/* SPDX-License-Identifier: 0BSD */
/* Ports of the outermost process.
 *
 * A reading end of a sampled input has a session, which begins when its reader first waits for a sample and lasts until the
 * process ends; during the session, each sample must be taken before the next one arrives. Before the session, while its process follows
 * the ticks through another end, it holds the sample of the present tick, so a first read belongs to the same instant as other reads of the process.
 * A value from outside communicates when a reader takes it.
 */
#include "csp_internal.h"
#include "csp_shared.h"

static void set_attend(csp_guard *watchers, bool attends)
{
    for (csp_guard *guard = watchers; guard != NULL; guard = guard->next) {
        csp_set_attends(guard, attends);
    }
}

/* ---- Sampled inputs ---- */

void csp_sampled_input_init(csp_sampled_input *port, uint32_t number, int64_t period, void *value, const csp_driver *driver)
{
    port->medium.number = number;
    port->medium.kind = (uint8_t)CSP_AT_ONCE;
    port->period = period;
    port->next = period;
    port->value = value;
    port->driver = *driver;
}

/* Whether two ports have the same ticks; valid before the first tick only. */
static bool have_same_ticks(const csp_sampled_input *one, const csp_sampled_input *other)
{
    return (one->period == other->period) && (one->next == other->next);
}

void csp_sampled_end_init(csp_sampled_end *end, csp_sampled_input *port, csp_ends *owner)
{
    end->medium.number = port->medium.number;
    end->medium.kind = (uint8_t)CSP_SAMPLED_END;
    end->port = port;
    end->next = NULL;
    end->next_of_owner = NULL;
    end->pace = end;
    csp_sampled_end **last = &port->ends;
    while (*last != NULL) {
        last = &(*last)->next;
    }
    *last = end;
    last = &owner->first;
    while (*last != NULL) {
        if ((end->pace == end) && have_same_ticks((*last)->port, port)) {
            end->pace = (*last)->pace;
        }
        last = &(*last)->next_of_owner;
    }
    *last = end;
}

void csp_sampled_begin(csp_sampled_end *end)
{
    if (!end->begun) {
        end->begun = true;
        set_attend(end->inputs, false);
    }
}

/* Keeps the sample of the present tick for a first read; overwriting it is not a missed sample. */
static void hold(csp_kernel *csp, csp_sampled_end *end)
{
    end->fresh = true;
    csp_raise_bits(csp, end->inputs);
}

static void miss(csp_sampled_end *end, int64_t samples)
{
    const uint32_t room = UINT32_MAX - end->port->missed;
    end->port->missed += (samples < (int64_t)room) ? (uint32_t)samples : room;
    end->overdue = !end->port->counts;
}

static void sample(csp_kernel *csp, csp_sampled_end *end)
{
    csp_sampled_end *const pace = end->pace;
    if (!end->begun) {
        hold(csp, end);
        return;
    }
    if (!pace->followed) {
        pace->followed = true;
        for (csp_sampled_end *other = pace; other != NULL; other = other->next_of_owner) {
            if ((other->pace == pace) && !other->begun && other->port->sampled) {
                hold(csp, other);
            }
        }
    }
    if (end->fresh) {
        miss(end, 1);
    }
    end->fresh = true;
    if (end->reader != NULL) {
        csp_party *const reader = end->reader;
        end->reader = NULL;
        csp_ready(csp, reader);
    }
    csp_raise_bits(csp, end->inputs);
}

void csp_sampled_tick(csp_kernel *csp, csp_sampled_input *port)
{
    if ((port->driver.read == NULL) || !csp_device_read(csp, &port->medium, &port->driver, port->value)) {
        return;
    }
    port->sampled = true;
    csp_observe_sample(csp, port->medium.number, port->value);
    for (csp_sampled_end *end = port->ends; end != NULL; end = end->next) {
        if (end->begun || end->pace->followed) {
            sample(csp, end);
        }
    }
}

void csp_sampled_skip(csp_sampled_input *port, int64_t ticks)
{
    for (csp_sampled_end *end = (port->driver.read == NULL) ? NULL : port->ends; end != NULL; end = end->next) {
        if (end->begun) {
            miss(end, ticks);
        }
    }
}

csp_progress csp_sampled_take(csp_kernel *csp, csp_party *party, csp_sampled_end *end, void *value, size_t size)
{
    if (end->overdue) {
        end->overdue = false;
        (void)csp_raise(csp, NULL, (uint16_t)CSP_TIMEOUT_EXCEPTION, NULL);
        csp->error.operands.integers[0] = (int64_t)end->medium.number;
        return CSP_FAILS;
    }
    csp_sampled_begin(end);
    end->fresh = false;
    csp_lower_bits(end->inputs);
    csp_copy(value, end->port->value, size);
    csp_observe(csp, end->medium.number, value, 0U, party->number);
    return CSP_DONE;
}

csp_progress csp_sampled_read_any(csp_kernel *csp, csp_party *party, csp_sampled_end *end, void *value, size_t size)
{
    if (csp_is_cancelled(party)) {
        return csp_refuse(csp, party);
    }
    if (end->fresh) {
        return csp_sampled_take(csp, party, end, value, size);
    }
    party->slot = value;
    end->reader = party;
    csp_sampled_begin(end);
    return CSP_WAITS;
}

void csp_ends_close(csp_ends *ends)
{
    for (csp_sampled_end *end = ends->first; end != NULL; end = end->next_of_owner) {
        end->begun = false;
        end->fresh = false;
        end->overdue = false;
        end->pace->followed = false;
        set_attend(end->inputs, true);
        csp_lower_bits(end->inputs);
    }
}

bool csp_sampled_can_come(const csp_sampled_input *port)
{
    const csp_sampled_end *end = (port->driver.read == NULL) ? NULL : port->ends;
    while ((end != NULL) &&
           !((end->begun || end->pace->followed) && ((end->reader != NULL) || csp_awaited(end->inputs)))) {
        end = end->next;
    }
    return end != NULL;
}

/* ---- Event inputs ---- */

static void add_end(csp_event_end *end, csp_event_input *port)
{
    csp_event_end **last = &port->ends;
    while (*last != NULL) {
        last = &(*last)->next;
    }
    end->medium.number = port->medium.number;
    end->medium.kind = (uint8_t)CSP_EVENT_END;
    end->port = port;
    end->next = NULL;
    *last = end;
}

void csp_event_input_init(csp_event_input *port, uint32_t number, bool broadcast, void *value, const csp_driver *driver)
{
    port->medium.number = number;
    port->medium.kind = (uint8_t)CSP_AT_ONCE;
    port->value = value;
    port->driver = *driver;
    port->broadcast = broadcast;
    if (!broadcast) {
        add_end(&port->shared, port);
    }
}

void csp_event_input_accept(csp_event_input *port, void *brought, size_t size)
{
    port->brought = brought;
    port->brought_size = size;
}

csp_event_end *csp_event_reader(csp_event_end *own, csp_event_input *port)
{
    if (port->broadcast) {
        add_end(own, port);
        return own;
    }
    return &port->shared;
}

void csp_event_occur(csp_kernel *csp, csp_event_input *port)
{
    for (csp_event_end *end = port->ends; end != NULL; end = end->next) {
        CSP_STORE(end->fresh, true);
        if (end->readers.first != NULL) {
            csp_ready(csp, csp_leave(&end->readers));
        }
        csp_raise_bits(csp, end->inputs);
    }
}

/* Whether an event has come that a reader has not taken. */
static bool is_unread(const csp_event_input *port)
{
    const csp_event_end *end = port->ends;
    while ((end != NULL) && !CSP_LOAD(end->fresh)) {
        end = end->next;
    }
    return CSP_LOAD(port->news) || (end != NULL);
}

bool csp_event_bring(csp_kernel *csp, csp_event_input *port, const void *value)
{
    bool overwrites = false;
    const uint32_t outside = csp_lock(csp);
    if (port->brought != NULL) {
        overwrites = is_unread(port);
        (void)memcpy(port->brought, value, port->brought_size);
        CSP_STORE(port->news, true);
    }
    csp_unlock(csp, outside);
    csp_announce_event(csp);
    return overwrites;
}

void csp_event_take_over(csp_kernel *csp, csp_event_input *port)
{
    if (CSP_LOAD(port->news)) {
        const uint32_t outside = csp_lock(csp);
        (void)memcpy(port->value, port->brought, port->brought_size);
        CSP_STORE(port->news, false);
        csp_event_occur(csp, port); /* before another event comes, which has to find this one */
        csp_unlock(csp, outside);
    }
}

void csp_event_poll(csp_kernel *csp, csp_event_input *port)
{
    if ((port->driver.read != NULL) && csp_device_read(csp, &port->medium, &port->driver, port->value)) {
        csp_event_occur(csp, port);
    }
}

void csp_event_take(csp_kernel *csp, csp_party *party, csp_event_end *end, void *value, size_t size)
{
    CSP_STORE(end->fresh, false);
    csp_lower_bits(end->inputs);
    csp_copy(value, end->port->value, size);
    csp_observe(csp, end->medium.number, value, 0U, party->number);
}

void csp_event_pass_on(csp_kernel *csp, csp_event_end *end)
{
    if (end->fresh && (end->readers.first != NULL)) {
        csp_ready(csp, csp_leave(&end->readers));
    }
}

csp_progress csp_event_read(csp_kernel *csp, csp_party *party, csp_event_end *end, void *value, size_t size)
{
    if (csp_is_cancelled(party)) {
        return csp_refuse(csp, party);
    }
    if (end->fresh) {
        csp_event_take(csp, party, end, value, size);
        return CSP_DONE;
    }
    party->slot = value;
    csp_enter(&end->readers, party);
    return CSP_WAITS;
}

csp_progress csp_event_read_again(csp_kernel *csp, csp_party *party, csp_event_end *end, void *value, size_t size)
{
    if (csp_is_cancelled(party)) {
        csp_event_pass_on(csp, end);
        return csp_refuse(csp, party);
    }
    if (end->fresh) {
        csp_event_take(csp, party, end, value, size);
        return CSP_DONE;
    }
    csp_enter_front(&end->readers, party);
    return CSP_WAITS;
}

bool csp_event_can_come(const csp_event_input *port, bool interrupts)
{
    const bool connected = (port->driver.read != NULL) || (interrupts && (port->brought != NULL));
    const csp_event_end *end = connected ? port->ends : NULL;
    while ((end != NULL) && (end->readers.first == NULL) && !csp_awaited(end->inputs)) {
        end = end->next;
    }
    return end != NULL;
}

/* ---- Outputs ---- */

void csp_latched_output_init(csp_latched_output *output, uint32_t number, int64_t period, void *value,
                             const csp_driver *driver)
{
    output->medium.number = number;
    output->medium.kind = (uint8_t)CSP_AT_ONCE;
    output->period = period;
    output->next = period;
    output->value = value;
    output->driver = *driver;
}

void csp_direct_output_init(csp_direct_output *output, uint32_t number, const csp_driver *driver)
{
    output->medium.number = number;
    output->medium.kind = (uint8_t)CSP_AT_ONCE;
    output->driver = *driver;
}

csp_progress csp_direct_write(csp_kernel *csp, csp_party *party, csp_direct_output *output, void *value, size_t size)
{
    (void)size;
    csp_device_write(csp, &output->medium, &output->driver, value);
    csp_observe(csp, output->medium.number, value, party->number, 0U);
    return CSP_DONE;
}

void csp_latched_tick(csp_kernel *csp, csp_latched_output *output)
{
    if (output->written) {
        output->written = false;
        csp_device_write(csp, &output->medium, &output->driver, output->value);
        csp_observe(csp, output->medium.number, output->value, output->writer, 0U);
    }
}
