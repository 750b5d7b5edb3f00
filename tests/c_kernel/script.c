#include "script.h"

#include <stdio.h>

enum { FAILS = SCRIPT_STEPS + 1 };

csp_kernel script_kernel;

static const char *const *names;
static const script *all;

static csp_progress read_from(csp_kernel *csp, csp_party *party, csp_medium *medium, int64_t *value, bool again)
{
    switch (medium->kind) {
    case CSP_CHANNEL:
        return again ? CSP_DONE : csp_channel_read(csp, party, (csp_channel *)(void *)medium, value, sizeof(*value));
    case CSP_GUARDED:
        return again ? CSP_DONE
                     : csp_guarded_read(csp, party, (csp_guarded_channel *)(void *)medium, value, sizeof(*value));
    case CSP_ANY:
        return again ? CSP_DONE : csp_any_read(csp, party, (csp_any_channel *)(void *)medium, value, sizeof(*value));
    case CSP_BUFFER:
        return again ? CSP_DONE : csp_buffer_read(csp, party, (csp_buffer *)(void *)medium, value, sizeof(*value));
    case CSP_BROADCAST_END:
        return again ? CSP_DONE
                     : csp_broadcast_read(csp, party, (csp_broadcast_end *)(void *)medium, value, sizeof(*value));
    case CSP_SAMPLED_END:
        return csp_sampled_read(csp, party, (csp_sampled_end *)(void *)medium, value, sizeof(*value));
    default:
        return again ? csp_event_read_again(csp, party, (csp_event_end *)(void *)medium, value, sizeof(*value))
                     : csp_event_read(csp, party, (csp_event_end *)(void *)medium, value, sizeof(*value));
    }
}

static csp_progress write_to(csp_kernel *csp, csp_party *party, csp_medium *medium, int64_t *value)
{
    switch (medium->kind) {
    case CSP_CHANNEL:
        return csp_channel_write(csp, party, (csp_channel *)(void *)medium, value, sizeof(*value));
    case CSP_GUARDED:
        return csp_guarded_write(csp, party, (csp_guarded_channel *)(void *)medium, value, sizeof(*value));
    case CSP_ANY:
        return csp_any_write(csp, party, (csp_any_channel *)(void *)medium, value, sizeof(*value));
    case CSP_BUFFER:
        return csp_buffer_write(csp, party, (csp_buffer *)(void *)medium, value, sizeof(*value));
    case CSP_BROADCAST:
        return csp_broadcast_write(csp, party, (csp_broadcast *)(void *)medium, value, sizeof(*value));
    default:
        return csp_latched_write(party, (csp_latched_output *)(void *)medium, value, sizeof(*value));
    }
}

static void prepare_guard(script *self, const script_step *step)
{
    csp_interrupt_init(&self->interrupt,
                       (uint32_t)((const char *)step->process - (const char *)self));
    csp_interrupt_prepare(&self->interrupt);
    if (step->medium == NULL) {
        csp_guard_after(&self->interrupt.alternative, 0U, &self->interrupt.timer);
        csp_delay(&self->interrupt.alternative, 0U, step->rank * INT64_C(1000000));
    } else if (step->writes) {
        self->written = step->value;
        csp_guard_write(&self->interrupt.alternative, 0U, step->medium, &self->written, sizeof(self->written));
    } else {
        csp_guard_read(&self->interrupt.alternative, 0U, step->medium, &self->value, sizeof(self->value));
    }
}

/* Begins the action of a step, or continues it. */
static csp_progress act(csp_kernel *csp, csp_party *party, script *self, const script_step *step, bool again)
{
    const bool cancelled = csp_is_cancelled(party);
    switch (step->action) {
    case READ:
        if (!again && cancelled) {
            return csp_refuse(csp, party);
        }
        return read_from(csp, party, step->medium, &self->value, again);
    case WRITE:
        if (again) {
            return CSP_DONE;
        }
        if (cancelled) {
            return csp_refuse(csp, party);
        }
        self->written = (step->value == 0) ? self->value : step->value;
        return write_to(csp, party, step->medium, &self->written);
    case SELECT:
        return again ? csp_select_again(csp, party, step->alternative) : csp_select(csp, party, step->alternative);
    case DELAY:
        return again ? csp_wait_again(party) : csp_wait(csp, party, &self->timer, step->value * 1000000);
    case STOP:
        return csp_stop(csp, party);
    case PARALLEL:
        return again ? csp_par_again(csp, party, &self->parallel)
                     : csp_par(csp, party, &self->parallel, step->branches, step->branch_runs);
    case INTERRUPT:
        if (!again) {
            prepare_guard(self, step);
        }
        return again ? csp_interruptible_again(csp, party, &self->interrupt)
                     : csp_interruptible(csp, party, &self->interrupt);
    case OFFER: {
        const uint32_t position = self->offers.used;
        csp_party *offer = NULL;
        csp_progress progress = CSP_DONE;
        if (((step == self->steps) || (step[-1].action != OFFER)) &&
            (csp_offers_begin(csp, party, &self->offers) == CSP_FAILS)) {
            return CSP_FAILS;
        }
        offer = csp_offer_next(&self->offers);
        self->offered[position] = step->value;
        if (csp_offer_refused(csp, &self->offers, step->medium)) {
            progress = CSP_FAILS;
        } else if (step->writes) {
            progress = write_to(csp, offer, step->medium, &self->offered[position]);
        } else {
            progress = read_from(csp, offer, step->medium, &self->offered[position], false);
        }
        return csp_offer_made(csp, &self->offers, step->medium, sizeof(int64_t), progress);
    }
    case TOGETHER:
        return again ? csp_offers_again(party, &self->offers) : csp_offers_wait(&self->offers);
    case SAY:
        printf("%6.1f ms  %s: %s %lld\n", (double)csp->now / 1e6, self->name, step->text,
               (long long)self->value);
        return CSP_DONE;
    default:
        return CSP_DONE;
    }
}

static uint16_t following(script *self, const script_step *step, uint16_t number)
{
    switch (step->action) {
    case SELECT:
        return (uint16_t)(step->jump + step->alternative->chosen);
    case JUMP:
        return step->jump;
    case REPEAT:
        self->repeated++;
        return (self->repeated < step->value) ? step->jump : (uint16_t)(number + 1U);
    case INTERRUPT:
        return self->interrupt.taken ? step->jump : (uint16_t)(number + 1U);
    case TRY:
        self->handler = step->jump;
        self->caught = step->exception;
        return (uint16_t)(number + 1U);
    default:
        return (uint16_t)(number + 1U);
    }
}

static csp_party *script_step_function(csp_kernel *csp, csp_party *party)
{
    script *const self = (script *)(void *)party;
    uint16_t number = 0U;
    bool again = false;
    csp_progress progress = CSP_DONE;
    if (party->state == 0U) {
        self->repeated = 0;
        self->caught = 0U;
        csp_observe_begin(csp, party->number);
    } else if (party->state == (uint16_t)FAILS) {
        progress = CSP_FAILS;
    } else {
        number = (uint16_t)(party->state - 1U);
        again = true;
    }
    for (;;) {
        const script_step *const step = &self->steps[number];
        if (progress == CSP_FAILS) {
            csp_unwind(csp, party);
            if ((self->caught == 0U) || !csp_catch(csp, self->caught)) {
                break;
            }
            self->caught = 0U;
            number = self->handler;
            progress = CSP_DONE;
            continue;
        }
        if (step->action == END) {
            csp_ends_close(&self->ends);
            csp_observe_end(csp, party->number);
            return csp_end(csp, party);
        }
        if ((step->action == CALL) && !again) {
            party->state = (uint16_t)(number + 1U);
            return csp_call(party, &step->process->process);
        }
        progress = (step->action == RAISE) ? csp_raise(csp, party, step->exception, "test.csp:1")
                                           : act(csp, party, self, step, again);
        again = false;
        if (progress != CSP_DONE) {
            party->state = (uint16_t)(number + 1U);
        }
        if (progress == CSP_WAITS) {
            return NULL;
        }
        if (progress == CSP_DONE) {
            number = following(self, step, number);
        }
    }
    csp_ends_close(&self->ends);
    csp_observe_end(csp, party->number);
    return csp_fail(csp, party);
}

static uint8_t waiting_of(const script_step *step)
{
    switch (step->action) {
    case READ:
        return (uint8_t)CSP_AT_READ;
    case WRITE:
        return (uint8_t)CSP_AT_WRITE;
    case SELECT:
        return (uint8_t)CSP_AT_ALTERNATIVE;
    case DELAY:
        return (uint8_t)CSP_AT_DELAY;
    case STOP:
        return (uint8_t)CSP_AT_STOP;
    case CALL:
        return (uint8_t)CSP_AT_CALL;
    case PARALLEL:
        return (uint8_t)CSP_AT_PARALLEL;
    case INTERRUPT:
        return (uint8_t)CSP_AT_INTERRUPT;
    case TOGETHER:
        return (uint8_t)(step[-1].writes ? CSP_AT_OUTPUTS : CSP_AT_INPUTS);
    default:
        return (uint8_t)CSP_AT_NOTHING;
    }
}

static void complete_place(script *self, const script_step *step, csp_place *place, uint16_t number)
{
    place->waiting = waiting_of(step);
    place->failed = (uint16_t)FAILS;
    place->where = "test.csp:1";
    switch (step->action) {
    case READ:
    case WRITE:
        self->waits_at[number] = step->medium;
        place->indirect = true;
        place->offset = (uint32_t)(offsetof(script, waits_at) + (number * sizeof(csp_medium *)));
        break;
    case SELECT:
        self->waits_at[number] = (csp_medium *)(void *)step->alternative;
        place->indirect = true;
        place->offset = (uint32_t)(offsetof(script, waits_at) + (number * sizeof(csp_medium *)));
        break;
    case DELAY:
        place->offset = (uint32_t)offsetof(script, timer);
        break;
    case CALL:
        place->offset = (uint32_t)((const char *)step->process - (const char *)self);
        break;
    case PARALLEL:
        place->offset = (uint32_t)offsetof(script, parallel);
        break;
    case INTERRUPT:
        place->offset = (uint32_t)offsetof(script, interrupt);
        break;
    default:
        place->offset = (uint32_t)offsetof(script, offers);
        break;
    }
}

void script_init(script *self, uint32_t number, const char *name, const script_step *steps)
{
    self->steps = steps;
    self->name = name;
    self->kind.step = script_step_function;
    self->kind.places = self->places;
    self->kind.name = name;
    self->kind.where = "test.csp:1";
    self->places[0].failed = (uint16_t)FAILS;
    self->places[FAILS].failed = (uint16_t)FAILS;
    for (uint16_t step = 0U; step < SCRIPT_STEPS; step++) {
        complete_place(self, &steps[step], &self->places[step + 1U], step);
    }
    csp_process_init(&self->process, &self->kind, number);
    csp_offers_init(&self->offers, self->offer, SCRIPT_OFFERS);
}

static void name_process(uint32_t number, char *text, size_t size)
{
    (void)snprintf(text, size, "%s", all[number - 1U].name);
}

static void name_channel(uint32_t number, char *text, size_t size)
{
    (void)snprintf(text, size, "%s", names[number]);
}

void csp_observe(csp_kernel *csp, uint32_t channel, const void *value, uint32_t writer, uint32_t reader)
{
    printf("%6.1f ms  %s %lld  %s -> %s\n", (double)csp->now / 1e6, names[channel], (long long)*(const int64_t *)value,
           (writer == 0U) ? "outside" : all[writer - 1U].name, (reader == 0U) ? "outside" : all[reader - 1U].name);
}

void csp_observe_sample(csp_kernel *csp, uint32_t port, const void *value)
{
    (void)csp;
    (void)port;
    (void)value;
}

void csp_observe_release(csp_kernel *csp, uint32_t port, const void *value)
{
    printf("%6.1f ms  release %s %lld\n", (double)csp->now / 1e6, names[port],
           (long long)*(const int64_t *)value);
}

void csp_observe_begin(csp_kernel *csp, uint32_t number)
{
    printf("%6.1f ms  %s begins\n", (double)csp->now / 1e6, all[number - 1U].name);
}

void csp_observe_end(csp_kernel *csp, uint32_t number)
{
    printf("%6.1f ms  %s ends\n", (double)csp->now / 1e6, all[number - 1U].name);
}

static void print_waiting(csp_kernel *csp, const csp_waiting_process *waiting, void *context)
{
    (void)context;
    char text[200];
    csp_describe_waiting(csp, waiting, text, sizeof(text));
    printf("           %s\n", text);
}

/* The parts of these programs are variables of their own, at any distance from the kernel. */
static ptrdiff_t way_to(const void *part)
{
    return (ptrdiff_t)((intptr_t)part - (intptr_t)&script_kernel);
}

void script_run(script *scripts, const char *const *channel_names, const script_port *ports, uint32_t port_count,
                csp_environment *environment, int64_t until)
{
    static const char *const exceptions[] = {"Alarm", "Other"};
    static const char *const endings[] = {"terminated", "failed", "deadlock", "time limit", "stopped"};
    static csp_port table[SCRIPT_PORTS];
    const csp_program program = {
        .process = way_to(&scripts[0].process), .ports = table, .port_count = port_count, .environment = environment,
        .process_name = name_process, .channel_name = name_channel, .exception_names = exceptions};
    csp_kernel *const csp = &script_kernel;
    char text[200];
    names = channel_names;
    all = scripts;
    for (uint32_t index = 0U; index < port_count; index++) {
        const csp_port port = {ports[index].kind, way_to(ports[index].medium), ports[index].safe, NULL, 0U};
        table[index] = port;
    }
    csp_build(csp, &program, csp_port_hooks());
    const csp_ending ending = csp_run(csp, until);
    printf("%6.1f ms  %s\n", (double)csp->now / 1e6, endings[ending]);
    if (ending == CSP_DEADLOCK) {
        csp_report_waiting(csp, print_waiting, NULL);
    }
    if (ending == CSP_FAILED) {
        csp_describe_error(csp, text, sizeof(text));
        printf("           %s\n", text);
    }
}
