/* SPDX-License-Identifier: 0BSD
 *
 * See commstime_api.h.
 */
#include "csp_config.h" /* first: what it renames is renamed in every header */

#include "commstime_api.h"

#include "csp_shared.h"
#include "csp_text.h"
#include "network.h"
#include "network_pointers.h"

struct commstime_instance {
    struct network network;
    commstime_hooks hooks;
    csp_hooks kernel_hooks;
    uint32_t build;
    const csp_program *program;
    const void *place; /* where it was begun */
    uint32_t checksum; /* of a copy */
};

/* COMMSTIME_SIZE was computed without a compiler. No option of one may make a length in a header by
 * hand larger.
 */
typedef char commstime_size_is_too_small[(sizeof(commstime_instance) <= COMMSTIME_SIZE) ? 1 : -1];

/* Their offsets are their alignments. */
struct commstime_aligned_memory {
    char before;
    commstime_memory memory;
};
struct commstime_aligned_instance {
    char before;
    commstime_instance instance;
};
typedef char commstime_alignment_is_too_small[
    (offsetof(struct commstime_aligned_instance, instance)
                <= offsetof(struct commstime_aligned_memory, memory))
        ? 1
        : -1];

/* Identifies the program and its kernel. */
static const uint32_t build = UINT32_C(0x00000000);

/* ---- The hooks of the kernel ---- */

static void wake(void *context)
{
    const commstime_instance *const self = context;
    if (self->hooks.wake != NULL) {
        self->hooks.wake(self->hooks.context);
    }
}

static void alive(void *context)
{
    const commstime_instance *const self = context;
    if (self->hooks.alive != NULL) {
        self->hooks.alive(self->hooks.context);
    }
}

#if CSP_MEASURE
static uint32_t cycles(void *context)
{
    const commstime_instance *const self = context;
    return self->hooks.cycles(self->hooks.context);
}

static void measured(void *context, uint32_t process, uint32_t took)
{
    const commstime_instance *const self = context;
    commstime_times *const times = self->hooks.times;
    uint32_t *longest = (process == CSP_OUTSIDE) ? &times->kernel : &times->instant;
    if ((process > 0U) && (process <= COMMSTIME_PROCESSES)) {
        longest = &times->process[process - 1U];
    }
    if (took > *longest) {
        *longest = took;
    }
}
#endif

#if CSP_TRACE_HOOK
static void trace(void *context, uint32_t channel, const void *value, uint32_t writer,
    uint32_t reader)
{
    const commstime_instance *const self = context;
    const commstime_communication communication = {
        self->network.kernel.now, channel, writer, reader, value, network_channel_sizes[channel]};
    self->hooks.trace(self->hooks.context, &communication);
}
#endif

static void connect(commstime_instance *self)
{
    const struct network_drivers drivers = {0};
    network_initialize(&self->network, &drivers, &self->kernel_hooks);
}

/* ---- The interface ---- */

static bool is_begun(const commstime_instance *self)
{
    return (self->place == self) && (self->program == &network_program) && (self->build == build);
}

static const char *refused(const void *memory, size_t size, const commstime_hooks *hooks)
{
    if (memory == NULL) {
        return "there is no memory";
    }
    if (size < sizeof(commstime_instance)) {
        return "the memory is too small: commstime_memory is large enough";
    }
    if (((uintptr_t)memory % offsetof(struct commstime_aligned_memory, memory)) != 0U) {
        return "the memory is misaligned: commstime_memory has the alignment";
    }
    if (hooks == NULL) {
        return "there are no hooks";
    }
#if !CSP_TRACE_HOOK
    if (hooks->trace != NULL) {
        return "the hook `trace` needs -DCSP_TRACE_HOOK=1";
    }
#endif
    return NULL;
}

commstime_instance *commstime_begin(void *memory, size_t size, const commstime_hooks *hooks,
    const char **reason)
{
    commstime_instance *const self = memory;
    const char *const found = refused(memory, size, hooks);
    if (reason != NULL) {
        *reason = found;
    }
    if (found != NULL) {
        return NULL;
    }
    if (is_begun(self)) {
        csp_release_outputs(&self->network.kernel);
    }
    const commstime_hooks given = *hooks; /* they may be those of the instance */
    (void)memset(self, 0, sizeof *self);
    self->hooks = given;
    self->kernel_hooks.context = self;
    self->kernel_hooks.real_time = given.real_time;
    self->kernel_hooks.wake = wake;
    self->kernel_hooks.alive = alive;
#if CSP_MEASURE
    if ((given.cycles != NULL) && (given.times != NULL)) {
        self->kernel_hooks.cycles = cycles;
        self->kernel_hooks.measured = measured;
    }
#endif
#if CSP_TRACE_HOOK
    if (given.trace != NULL) {
        self->kernel_hooks.trace = trace;
    }
#endif
    self->build = build;
    self->program = &network_program;
    self->place = self;
    connect(self);
    (void)csp_begin(&self->network.kernel);
    return self;
}

commstime_state commstime_advance(commstime_instance *self, int64_t until, uint32_t steps)
{
    commstime_state state = COMMSTIME_REFUSED;
    switch (csp_advance(&self->network.kernel, until, steps)) {
    case CSP_MORE:
        return COMMSTIME_MORE;
    case CSP_BUDGET:
        return COMMSTIME_BUDGET;
    case CSP_TERMINATED:
        state = COMMSTIME_ENDED;
        break;
    case CSP_FAILED:
        state = COMMSTIME_FAILED;
        break;
    case CSP_DEADLOCK:
        state = COMMSTIME_DEADLOCK;
        break;
    case CSP_STOPPED:
        state = COMMSTIME_STOPPED;
        break;
    default:
        return COMMSTIME_REFUSED;
    }
    if (csp_is_driving(&self->network.kernel)) {
        if ((self->hooks.fault != NULL)
                && ((state == COMMSTIME_FAILED) || (state == COMMSTIME_DEADLOCK))) {
            self->hooks.fault(self->hooks.context, self);
        }
        csp_release_outputs(&self->network.kernel);
    }
    return state;
}

int64_t commstime_next(commstime_instance *self)
{
    return csp_next(&self->network.kernel);
}

void commstime_hand_over(commstime_instance *self, int64_t instant)
{
    csp_hand_over(&self->network.kernel, instant);
}

void commstime_finish(commstime_instance *self)
{
    csp_finish(&self->network.kernel);
}

void commstime_release(commstime_instance *self)
{
    csp_release_outputs(&self->network.kernel);
    CSP_STORE(self->network.kernel.stop_requested, true);
}

void commstime_stop(commstime_instance *self)
{
    csp_request_stop(&self->network.kernel);
}

/* ---- Copies ---- */

/* Depends on program, kernel, compiler, and the places of functions and constants in the image. */
static uint32_t identity(void)
{
    uint32_t sum = csp_checksum(CSP_CHECKSUM_BEGIN, &build, sizeof build);
    const uintptr_t fixed[] = {
        sizeof(commstime_instance),
        (uintptr_t)&build - (uintptr_t)&network_program,
        (uintptr_t)network_program.ports - (uintptr_t)&network_program,
        (uintptr_t)&network_pointers - (uintptr_t)&network_program
    };
    sum = csp_checksum(sum, fixed, sizeof fixed);
    for (uint32_t index = 0U; index < CSP_NETWORK_FUNCTIONS; index++) {
        uintptr_t distance = 0U;
        (void)memcpy(&distance, &network_functions[index], sizeof distance);
        distance -= (uintptr_t)&network_program;
        sum = csp_checksum(sum, &distance, sizeof distance);
    }
    return sum;
}

static uint32_t checksum_of(const commstime_instance *copy)
{
    uint32_t sum = csp_checksum(identity(), &copy->network, sizeof copy->network);
    return sum;
}

static csp_saved_places places_of(const commstime_instance *self)
{
    return (csp_saved_places){self, sizeof *self, &network_program};
}

void commstime_save(const commstime_instance *self, commstime_memory *copy)
{
    commstime_instance *const saved = (void *)copy;
    csp_pointer_visit visits[CSP_NETWORK_DEPTH];
    (void)memset(copy, 0, sizeof *copy);
    if (!is_begun(self)) {
        return;
    }
    (void)memcpy(&saved->network, &self->network, sizeof saved->network);
    saved->network.kernel.hooks = NULL;
    csp_save_pointers(&saved->network, &network_pointers, visits, places_of(self));
    saved->checksum = checksum_of(saved);
}

bool commstime_restore(commstime_instance *self, const commstime_memory *copy)
{
    const commstime_instance *const saved = (const void *)copy;
    csp_kernel *const csp = &self->network.kernel;
    csp_pointer_visit visits[CSP_NETWORK_DEPTH];
    if (saved->checksum != checksum_of(saved)) {
        return false;
    }
    if (!saved->network.kernel.driving) {
        csp_release_outputs(csp);
    }
    const csp_hooks *const hooks = csp->hooks;
    const uint32_t before = csp_lock(csp);
    (void)memcpy(&self->network, &saved->network, sizeof self->network);
    csp_restore_pointers(&self->network, &network_pointers, visits, places_of(self));
    csp->hooks = hooks;
    csp->real_time = hooks->real_time;
    csp_unlock(csp, before);
    return true;
}

/* A text that grows. */
typedef struct report {
    char *text;
    size_t size;
} report;

static void add_waiting(csp_kernel *csp, const csp_waiting_process *waiting, void *context)
{
    const report *const all = context;
    const size_t length = strlen(all->text);
    csp_append(all->text, all->size, "\n  ");
    if ((length + 3U) < all->size) {
        csp_describe_waiting(csp, waiting, &all->text[length + 3U], all->size - length - 3U);
    }
}

void commstime_describe(commstime_instance *self, char *text, size_t size)
{
    csp_kernel *const csp = &self->network.kernel;
    report all = {text, size};
    if (size == 0U) {
        return;
    }
    text[0] = '\0';
    switch ((csp_ending)csp->ending) {
    case CSP_FAILED:
        csp_describe_error(csp, text, size);
        break;
    case CSP_DEADLOCK:
        csp_append(text, size, "deadlock");
        csp_report_waiting(csp, add_waiting, &all);
        break;
    case CSP_TERMINATED:
        csp_append(text, size, "ended by itself");
        break;
    case CSP_STOPPED:
        csp_append(text, size, "stopped");
        break;
    default:
        csp_append(text, size, (csp->phase == (uint8_t)CSP_FINISHED) ? "finished" : "running");
        if ((csp->current != NULL) && (csp->phase != (uint8_t)CSP_FINISHED)) {
            csp_append(text, size, ": ");
            csp_describe_current(csp, &text[strlen(text)], size - strlen(text));
        }
        break;
    }
}

static commstime_cause cause_of(const csp_error *error)
{
    switch (error->exception) {
    case CSP_FAULT_EXCEPTION:
        return COMMSTIME_CAUSE_FAULT;
    case CSP_TIMEOUT_EXCEPTION:
        return COMMSTIME_CAUSE_TIMEOUT;
    default:
        return COMMSTIME_CAUSE_EXCEPTION;
    }
}

bool commstime_diagnose(const commstime_instance *self, commstime_failure *failure)
{
    const csp_kernel *const csp = &self->network.kernel;
    const csp_error *const error = &csp->error;
    (void)memset(failure, 0, sizeof *failure);
    failure->instant = csp->now;
    failure->cause = COMMSTIME_CAUSE_DEADLOCK;
    if (csp->ending != (uint8_t)CSP_FAILED) {
        return csp->ending == (uint8_t)CSP_DEADLOCK;
    }
    failure->cause = cause_of(error);
    if (error->process == NULL) {
        return true;
    }
    failure->number = error->process->party.number;
    failure->process = error->process->kind->name;
    failure->inner = error->inner;
    failure->law = error->law;
    failure->place = (error->place != NULL) ? error->place : error->process->kind->where;
    if (failure->cause == COMMSTIME_CAUSE_EXCEPTION) {
        const uint32_t index = (uint32_t)error->exception - (uint32_t)CSP_FIRST_EXCEPTION;
        failure->exception = network_program.exception_names[index];
    }
    return true;
}

const char *commstime_channel_name(uint32_t channel)
{
#if CSP_TRACE_HOOK
    return (channel < network_channel_count) ? network_channel_names[channel] : "";
#else
    (void)channel;
    return "";
#endif
}

const char *commstime_process_name(uint32_t process)
{
#if CSP_TRACE_HOOK
    return (process <= network_process_count) ? network_process_names[process] : "";
#else
    (void)process;
    return "";
#endif
}

#if CSP_MEASURE
static void put_seconds(uint32_t counted, uint32_t hertz,
    void (*put)(void *context, const char *text), void *context)
{
    char number[24] = "";
    const uint64_t scaled = (uint64_t)counted * UINT64_C(1000000000);
    csp_append_integer(number, sizeof number, (int64_t)((scaled + hertz - 1U) / hertz));
    put(context, number);
    put(context, "e-9");
}
#endif

void commstime_write_times(const commstime_times *times, uint32_t hertz,
    void (*put)(void *context, const char *text), void *context)
{
    if (hertz == 0U) {
        return;
    }
    put(context, "{\"executionTimes\": {");
#if CSP_MEASURE
    bool others = false;
    for (uint32_t index = 0U; index < COMMSTIME_PROCESSES; index++) {
        if (times->process[index] > 0U) {
            put(context, others ? ",\n  \"" : "\n  \"");
            put(context, network_process_names[index + 1U]);
            put(context, "\": {\"longest\": ");
            put_seconds(times->process[index], hertz, put, context);
            put(context, ", \"what\": \"process\"}");
            others = true;
        }
    }
    put(context, "\n}, \"kernelTime\": ");
    put_seconds(times->kernel, hertz, put, context);
    put(context, "}\n");
#else
    (void)times;
    put(context, "}}\n");
#endif
}
