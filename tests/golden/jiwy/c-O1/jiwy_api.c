/* SPDX-License-Identifier: 0BSD
 *
 * See jiwy_api.h.
 */
#include "csp_config.h" /* first: what it renames is renamed in every header */

#include "jiwy_api.h"

#include "csp_shared.h"
#include "csp_text.h"
#include "network.h"
#include "network_pointers.h"

struct jiwy_instance {
    struct network network;
    jiwy_hooks hooks;
    csp_hooks kernel_hooks;
    jiwy_inputs inputs;
    jiwy_outputs outputs;
    uint32_t build;
    const csp_program *program;
    const void *place; /* where it was begun */
    uint32_t checksum; /* of a copy */
};

/* JIWY_SIZE was computed without a compiler. No option of one may make a length in a header by hand
 * larger.
 */
typedef char jiwy_size_is_too_small[(sizeof(jiwy_instance) <= JIWY_SIZE) ? 1 : -1];

/* Their offsets are their alignments. */
struct jiwy_aligned_memory {
    char before;
    jiwy_memory memory;
};
struct jiwy_aligned_instance {
    char before;
    jiwy_instance instance;
};
typedef char jiwy_alignment_is_too_small[
    (offsetof(struct jiwy_aligned_instance, instance)
                <= offsetof(struct jiwy_aligned_memory, memory))
        ? 1
        : -1];

/* Identifies the program and its kernel. */
static const uint32_t build = UINT32_C(0x00000000);

/* Asks for the sample of an input, which is in this member of the inputs then. */
static bool sample_input(jiwy_instance *self, jiwy_input input, void *value, const void *member,
    size_t size)
{
    const bool came = self->hooks.sample(self->hooks.context, input, &self->inputs);
    if (came) {
        (void)memcpy(value, member, size);
    }
    return came;
}

/* Hands over the value of an output, by this member of the outputs. */
static void actuate_output(jiwy_instance *self, jiwy_output output, const void *value, void *member,
    size_t size)
{
    (void)memcpy(member, value, size);
    self->hooks.actuate(self->hooks.context, output, &self->outputs,
        csp_is_releasing(&self->network.kernel));
}

static bool read_joystick_horizontal(void *device, void *value)
{
    jiwy_instance *const self = device;
    return sample_input(self, JIWY_IN_JOYSTICK_HORIZONTAL, value, &self->inputs.joystick_horizontal,
        sizeof self->inputs.joystick_horizontal);
}

static bool read_joystick_vertical(void *device, void *value)
{
    jiwy_instance *const self = device;
    return sample_input(self, JIWY_IN_JOYSTICK_VERTICAL, value, &self->inputs.joystick_vertical,
        sizeof self->inputs.joystick_vertical);
}

static bool read_feedback_horizontal(void *device, void *value)
{
    jiwy_instance *const self = device;
    return sample_input(self, JIWY_IN_FEEDBACK_HORIZONTAL, value, &self->inputs.feedback_horizontal,
        sizeof self->inputs.feedback_horizontal);
}

static bool read_feedback_vertical(void *device, void *value)
{
    jiwy_instance *const self = device;
    return sample_input(self, JIWY_IN_FEEDBACK_VERTICAL, value, &self->inputs.feedback_vertical,
        sizeof self->inputs.feedback_vertical);
}

static bool poll_joystick_buttons(void *device, void *value)
{
    const jiwy_instance *const self = device;
    return (self->hooks.poll != NULL)
        && self->hooks.poll(self->hooks.context, JIWY_EVENT_JOYSTICK_BUTTONS, value);
}

static void write_control_horizontal(void *device, const void *value)
{
    jiwy_instance *const self = device;
    actuate_output(self, JIWY_OUT_CONTROL_HORIZONTAL, value, &self->outputs.control_horizontal,
        sizeof self->outputs.control_horizontal);
}

static void write_control_vertical(void *device, const void *value)
{
    jiwy_instance *const self = device;
    actuate_output(self, JIWY_OUT_CONTROL_VERTICAL, value, &self->outputs.control_vertical,
        sizeof self->outputs.control_vertical);
}

/* ---- The hooks of the kernel ---- */

static uint32_t lock(void *context)
{
    const jiwy_instance *const self = context;
    return self->hooks.lock(self->hooks.context);
}

static void unlock(void *context, uint32_t before)
{
    const jiwy_instance *const self = context;
    self->hooks.unlock(self->hooks.context, before);
}

static void wake(void *context)
{
    const jiwy_instance *const self = context;
    if (self->hooks.wake != NULL) {
        self->hooks.wake(self->hooks.context);
    }
}

static void alive(void *context)
{
    const jiwy_instance *const self = context;
    if (self->hooks.alive != NULL) {
        self->hooks.alive(self->hooks.context);
    }
}

#if CSP_MEASURE
static uint32_t cycles(void *context)
{
    const jiwy_instance *const self = context;
    return self->hooks.cycles(self->hooks.context);
}

static void measured(void *context, uint32_t process, uint32_t took)
{
    const jiwy_instance *const self = context;
    jiwy_times *const times = self->hooks.times;
    uint32_t *longest = (process == CSP_OUTSIDE) ? &times->kernel : &times->instant;
    if ((process > 0U) && (process <= JIWY_PROCESSES)) {
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
    const jiwy_instance *const self = context;
    const jiwy_communication communication = {
        self->network.kernel.now, channel, writer, reader, value, network_channel_sizes[channel]};
    self->hooks.trace(self->hooks.context, &communication);
}
#endif

static void connect(jiwy_instance *self)
{
    const struct network_drivers drivers = {
        .joystick_horizontal = {.device = self, .read = read_joystick_horizontal},
        .joystick_vertical = {.device = self, .read = read_joystick_vertical},
        .joystick_buttons = {
            .device = self,
            .read = (self->hooks.poll != NULL) ? poll_joystick_buttons : NULL
        },
        .feedback_horizontal = {.device = self, .read = read_feedback_horizontal},
        .feedback_vertical = {.device = self, .read = read_feedback_vertical},
        .control_horizontal = {.device = self, .write = write_control_horizontal},
        .control_vertical = {.device = self, .write = write_control_vertical}
    };
    network_initialize(&self->network, &drivers, &self->kernel_hooks, self->hooks.parameters);
}

/* ---- The interface ---- */

static bool is_begun(const jiwy_instance *self)
{
    return (self->place == self) && (self->program == &network_program) && (self->build == build);
}

static const char *refused(const void *memory, size_t size, const jiwy_hooks *hooks)
{
    if (memory == NULL) {
        return "there is no memory";
    }
    if (size < sizeof(jiwy_instance)) {
        return "the memory is too small: jiwy_memory is large enough";
    }
    if (((uintptr_t)memory % offsetof(struct jiwy_aligned_memory, memory)) != 0U) {
        return "the memory is misaligned: jiwy_memory has the alignment";
    }
    if (hooks == NULL) {
        return "there are no hooks";
    }
    if (hooks->sample == NULL) {
        return "the hook `sample` is missing";
    }
    if (hooks->actuate == NULL) {
        return "the hook `actuate` is missing";
    }
    if ((hooks->lock == NULL) || (hooks->unlock == NULL)) {
        return "the hook `lock` or `unlock` is missing";
    }
#if !CSP_TRACE_HOOK
    if (hooks->trace != NULL) {
        return "the hook `trace` needs -DCSP_TRACE_HOOK=1";
    }
#endif
    return NULL;
}

jiwy_instance *jiwy_begin(void *memory, size_t size, const jiwy_hooks *hooks, const char **reason)
{
    jiwy_instance *const self = memory;
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
    const jiwy_hooks given = *hooks; /* they may be those of the instance */
    (void)memset(self, 0, sizeof *self);
    self->hooks = given;
    self->kernel_hooks.context = self;
    self->kernel_hooks.real_time = given.real_time;
    self->kernel_hooks.lock = lock;
    self->kernel_hooks.unlock = unlock;
    self->kernel_hooks.grid = given.grid;
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
    if (self->network.refusal.cause != (uint16_t)CSP_ACCEPTED) {
        self->place = NULL;
        if (reason != NULL) {
            *reason = "the parameters have values that the program cannot have";
        }
        return NULL;
    }
    (void)csp_begin(&self->network.kernel);
    return self;
}

jiwy_state jiwy_advance(jiwy_instance *self, int64_t until, uint32_t steps)
{
    jiwy_state state = JIWY_REFUSED;
    switch (csp_advance(&self->network.kernel, until, steps)) {
    case CSP_MORE:
        return JIWY_MORE;
    case CSP_BUDGET:
        return JIWY_BUDGET;
    case CSP_TERMINATED:
        state = JIWY_ENDED;
        break;
    case CSP_FAILED:
        state = JIWY_FAILED;
        break;
    case CSP_DEADLOCK:
        state = JIWY_DEADLOCK;
        break;
    case CSP_STOPPED:
        state = JIWY_STOPPED;
        break;
    default:
        return JIWY_REFUSED;
    }
    if (csp_is_driving(&self->network.kernel)) {
        if ((self->hooks.fault != NULL) && ((state == JIWY_FAILED) || (state == JIWY_DEADLOCK))) {
            self->hooks.fault(self->hooks.context, self);
        }
        csp_release_outputs(&self->network.kernel);
    }
    return state;
}

void jiwy_defaults(jiwy_parameters *parameters)
{
    *parameters = network_default_parameters;
}

void jiwy_get(const jiwy_instance *self, jiwy_parameters *parameters)
{
    *parameters = self->network.parameters;
}

bool jiwy_set(jiwy_instance *self, const jiwy_parameters *parameters)
{
    return network_change_parameters(&self->network, parameters);
}

jiwy_refusal jiwy_why_refused(const jiwy_instance *self, jiwy_parameter *parameter)
{
    if (parameter != NULL) {
        *parameter = (jiwy_parameter)self->network.refusal.parameter;
    }
    return (jiwy_refusal)self->network.refusal.cause;
}

int64_t jiwy_next(jiwy_instance *self)
{
    return csp_next(&self->network.kernel);
}

void jiwy_hand_over(jiwy_instance *self, int64_t instant)
{
    csp_hand_over(&self->network.kernel, instant);
}

void jiwy_finish(jiwy_instance *self)
{
    csp_finish(&self->network.kernel);
}

void jiwy_release(jiwy_instance *self)
{
    csp_release_outputs(&self->network.kernel);
    CSP_STORE(self->network.kernel.stop_requested, true);
}

void jiwy_stop(jiwy_instance *self)
{
    csp_request_stop(&self->network.kernel);
}

/* ---- Copies ---- */

/* Depends on program, kernel, compiler, and the places of functions and constants in the image. */
static uint32_t identity(void)
{
    uint32_t sum = csp_checksum(CSP_CHECKSUM_BEGIN, &build, sizeof build);
    const uintptr_t fixed[] = {
        sizeof(jiwy_instance),
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

static uint32_t checksum_of(const jiwy_instance *copy)
{
    uint32_t sum = csp_checksum(identity(), &copy->network, sizeof copy->network);
    sum = csp_checksum(sum, &copy->inputs, sizeof copy->inputs);
    sum = csp_checksum(sum, &copy->outputs, sizeof copy->outputs);
    return sum;
}

static csp_saved_places places_of(const jiwy_instance *self)
{
    return (csp_saved_places){self, sizeof *self, &network_program};
}

void jiwy_save(const jiwy_instance *self, jiwy_memory *copy)
{
    jiwy_instance *const saved = (void *)copy;
    csp_pointer_visit visits[CSP_NETWORK_DEPTH];
    (void)memset(copy, 0, sizeof *copy);
    if (!is_begun(self)) {
        return;
    }
    const uint32_t before = self->hooks.lock(self->hooks.context);
    (void)memcpy(&saved->network, &self->network, sizeof saved->network);
    self->hooks.unlock(self->hooks.context, before);
    saved->network.kernel.hooks = NULL;
    csp_save_pointers(&saved->network, &network_pointers, visits, places_of(self));
    saved->inputs = self->inputs;
    saved->outputs = self->outputs;
    saved->checksum = checksum_of(saved);
}

bool jiwy_restore(jiwy_instance *self, const jiwy_memory *copy)
{
    const jiwy_instance *const saved = (const void *)copy;
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
    self->inputs = saved->inputs;
    self->outputs = saved->outputs;
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

void jiwy_describe(jiwy_instance *self, char *text, size_t size)
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

static jiwy_cause cause_of(const csp_error *error)
{
    switch (error->exception) {
    case CSP_FAULT_EXCEPTION:
        return JIWY_CAUSE_FAULT;
    case CSP_TIMEOUT_EXCEPTION:
        return JIWY_CAUSE_TIMEOUT;
    default:
        return JIWY_CAUSE_EXCEPTION;
    }
}

bool jiwy_diagnose(const jiwy_instance *self, jiwy_failure *failure)
{
    const csp_kernel *const csp = &self->network.kernel;
    const csp_error *const error = &csp->error;
    (void)memset(failure, 0, sizeof *failure);
    failure->instant = csp->now;
    failure->cause = JIWY_CAUSE_DEADLOCK;
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
    if (failure->cause == JIWY_CAUSE_EXCEPTION) {
        const uint32_t index = (uint32_t)error->exception - (uint32_t)CSP_FIRST_EXCEPTION;
        failure->exception = network_program.exception_names[index];
    }
    return true;
}

const char *jiwy_channel_name(uint32_t channel)
{
#if CSP_TRACE_HOOK
    return (channel < network_channel_count) ? network_channel_names[channel] : "";
#else
    (void)channel;
    return "";
#endif
}

const char *jiwy_process_name(uint32_t process)
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

void jiwy_write_times(const jiwy_times *times, uint32_t hertz,
    void (*put)(void *context, const char *text), void *context)
{
    if (hertz == 0U) {
        return;
    }
    put(context, "{\"executionTimes\": {");
#if CSP_MEASURE
    bool others = false;
    for (uint32_t index = 0U; index < JIWY_PROCESSES; index++) {
        if (times->process[index] > 0U) {
            put(context, others ? ",\n  \"" : "\n  \"");
            put(context, network_process_names[index + 1U]);
            put(context, "\": {\"longest\": ");
            put_seconds(times->process[index], hertz, put, context);
            put(context, ", \"what\": \"thread\"}");
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

bool jiwy_joystick_buttons(jiwy_instance *self, int64_t value)
{
    return csp_event_bring(&self->network.kernel, &self->network.external.joystick_buttons, &value);
}
