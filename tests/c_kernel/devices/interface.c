/* The machine of devices/machine.csp by its step interface. Each part prints what happened; the argument chooses the part. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "machine_api.h"

#define MS INT64_C(1000000)

/* The devices. */
typedef struct plant {
    int samples;
    double level;
    bool silent;
    machine_outputs last;
    int driven;
    int released;
    int late_writes; /* values after the safe one */
    int turns;
    int wakes;
    int polls;
    bool pressed;
    pthread_mutex_t lock;
} plant;

static machine_memory memory;
static machine_memory other_memory;
static plant devices = {.lock = PTHREAD_MUTEX_INITIALIZER};
static plant other_devices = {.lock = PTHREAD_MUTEX_INITIALIZER};

static bool sample(void *context, machine_input input, machine_inputs *inputs)
{
    plant *const self = context;
    if (input == MACHINE_IN_LEVEL) {
        self->samples++;
        inputs->level = self->level + self->samples;
    }
    return !self->silent;
}

static void actuate(void *context, machine_output output, const machine_outputs *outputs, bool safe)
{
    plant *const self = context;
    self->last = *outputs;
    self->late_writes += (!safe && (self->released > 0)) ? 1 : 0;
    self->released += safe ? 1 : 0;
    self->driven += (!safe && (output == MACHINE_OUT_DRIVE)) ? 1 : 0;
}

static uint32_t lock(void *context)
{
    plant *const self = context;
    (void)pthread_mutex_lock(&self->lock);
    return 0U;
}

static void unlock(void *context, uint32_t before)
{
    plant *const self = context;
    (void)before;
    (void)pthread_mutex_unlock(&self->lock);
}

static void wake(void *context)
{
    plant *const self = context;
    (void)__atomic_fetch_add(&self->wakes, 1, __ATOMIC_SEQ_CST);
}

static void alive(void *context)
{
    ((plant *)context)->turns++;
}

static machine_hooks hooks_of(plant *self)
{
    const machine_hooks hooks = {.context = self, .sample = sample, .actuate = actuate, .lock = lock, .unlock = unlock,
                                 .wake = wake, .alive = alive};
    return hooks;
}

static machine_instance *begin(machine_memory *at, plant *self, bool real_time)
{
    machine_hooks hooks = hooks_of(self);
    hooks.real_time = real_time;
    return machine_begin(at, sizeof *at, &hooks, NULL);
}

static void show(machine_instance *self, machine_state state, const plant *of)
{
    char text[200] = "";
    machine_describe(self, text, sizeof text);
    (void)printf("state %d: %s; driven %d, last %g, released %d, afterwards %d\n", (int)state, text, of->driven,
                 of->last.drive, of->released, of->late_writes);
}

/* ---- Parts ---- */

static void try_to_begin(void *at, size_t size, const machine_hooks *hooks)
{
    const char *reason = "";
    const bool refused = machine_begin(at, size, hooks, &reason) == NULL;
    (void)printf("%d %s\n", refused, (reason == NULL) ? "" : reason);
}

static void refuse(void)
{
    const machine_hooks whole = hooks_of(&devices);
    machine_hooks without[4];
    for (size_t index = 0U; index < 4U; index++) {
        without[index] = whole;
    }
    without[0].sample = NULL;
    without[1].actuate = NULL;
    without[2].lock = NULL;
    without[3].unlock = NULL;
    for (size_t index = 0U; index < 4U; index++) {
        try_to_begin(&memory, sizeof memory, &without[index]);
    }
    try_to_begin(&memory, 100U, &whole);
    try_to_begin(&memory.bytes[1], sizeof memory, &whole);
    try_to_begin(NULL, sizeof memory, &whole);
    try_to_begin(&memory, sizeof memory, NULL);
    (void)printf("nothing done %d\n", (memory.bytes[0] == 0U) && (devices.samples == 0));
    try_to_begin(&memory, sizeof memory, &whole);
}

static void run(void)
{
    machine_instance *const self = begin(&memory, &devices, false);
    (void)printf("next %lld\n", (long long)(machine_next(self) / MS));
    machine_state state = machine_advance(self, 10 * MS, 1000U);
    show(self, state, &devices);
    (void)printf("next %lld, backwards %d, beyond the end %d\n", (long long)(machine_next(self) / MS),
                 (int)machine_advance(self, 9 * MS, 1U), (int)machine_advance(self, INT64_MAX, 1U));
    (void)printf("budget %d\n", (int)machine_advance(self, 20 * MS, 1U));
    (void)printf("overwritten %d", machine_button(self, false));
    (void)printf(" %d", machine_button(self, true));
    (void)printf(", wakes %d", devices.wakes);
    (void)machine_advance(self, 20 * MS, 0U); /* the event is at its port */
    (void)printf(", waiting %d\n", machine_button(self, true));
    state = machine_advance(self, 20 * MS, 1000U);
    show(self, state, &devices);
    (void)printf("lamp %d, alive %d, again %d, next %d\n", devices.last.lamp, devices.turns > 0,
                 (int)machine_advance(self, 30 * MS, 1U), machine_next(self) == INT64_MAX);
    machine_finish(self);
    (void)printf("after finish %d, released %d\n", (int)machine_advance(self, 30 * MS, 1U), devices.released);
    char text[20] = "";
    machine_instance *const again = begin(&memory, &devices, false);
    machine_describe(again, text, sizeof text);
    (void)printf("begun: %s", text);
    machine_finish(again);
    machine_describe(again, text, sizeof text);
    (void)printf(", in the end: %s\n", text);
}

static void reset(void)
{
    machine_instance *self = begin(&memory, &devices, false);
    (void)machine_advance(self, 10 * MS, 1000U);
    self = begin(&memory, &devices, false);
    (void)printf("released by the reset %d\n", devices.released);
    devices.released = 0;
    devices.driven = 0;
    machine_state state = machine_advance(self, 6 * MS, 1000U);
    (void)printf("next %lld ms", (long long)(machine_next(self) / MS));
    machine_stop(self);
    (void)printf(", after the stop %lld ms\n", (long long)(machine_next(self) / MS));
    state = machine_advance(self, 6 * MS, 1000U);
    show(self, state, &devices);
    self = begin(&memory, &devices, false);
    devices.released = 0;
    (void)machine_advance(self, 6 * MS, 1000U);
    machine_release(self);
    state = machine_advance(self, 20 * MS, 1000U);
    show(self, state, &devices);
}

static void be_late(void)
{
    machine_instance *self = begin(&memory, &devices, true);
    machine_state state = machine_advance(self, 3 * MS, 1000U);
    state = machine_advance(self, 10 * MS, 1000U);
    show(self, state, &devices);
    (void)memset(&memory, 0, sizeof memory);
    devices.samples = 0;
    devices.released = 0;
    self = begin(&memory, &devices, false);
    state = machine_advance(self, 3 * MS, 1000U);
    state = machine_advance(self, 10 * MS, 1000U);
    show(self, state, &devices);
}

static void sample_badly(void)
{
    machine_instance *self = begin(&memory, &devices, false);
    machine_state state = machine_advance(self, 5 * MS, 1000U);
    devices.silent = true;
    state = machine_advance(self, 20 * MS, 1000U);
    show(self, state, &devices);
    devices.silent = false;
    devices.level = NAN;
    state = machine_advance(self, 30 * MS, 1000U);
    show(self, state, &devices);
    for (size_t size = 0U; size < 10U; size++) {
        char *const text = malloc((size > 0U) ? size : 1U); /* as large as is said, which a sanitizer watches */
        text[0] = '\0';
        machine_describe(self, text, size);
        (void)printf("%s%s", text, (size < 9U) ? "," : "\n");
        free(text);
    }
    machine_finish(self);
    (void)printf("after finish %d\n", (int)machine_advance(self, 40 * MS, 1U));
}

/* Whatever happens between a copy and its return, the run is the same afterwards. */
static void restore(void)
{
    static machine_memory copy;
    machine_instance *const self = begin(&memory, &devices, false);
    machine_instance *const other = begin(&other_memory, &other_devices, false);
    for (unsigned round = 1U; round < 200U; round++) {
        const int64_t now = (int64_t)round * 777777;
        (void)machine_advance(self, now, 1000U);
        (void)machine_advance(other, now, 1000U);
        const plant kept = devices;
        machine_save(self, &copy);
        if ((round % 3U) == 0U) {
            (void)machine_button(self, true);
        }
        (void)machine_advance(self, now + (int64_t)(round * 99999U), 1 + (round % 7U));
        if (!machine_restore(self, &copy)) {
            (void)printf("refused\n");
        }
        devices.samples = kept.samples;
        devices.last = kept.last;
        devices.driven = kept.driven;
        devices.released = kept.released;
        devices.late_writes = kept.late_writes;
    }
    show(self, machine_advance(self, 160 * MS, 1000U), &devices);
    show(other, machine_advance(other, 160 * MS, 1000U), &other_devices);
    (void)machine_advance(self, 160 * MS, 1000U);
    machine_save(self, &copy);
    (void)printf("of another instance %d\n", machine_restore(other, &copy));
    other_devices = devices;
    (void)machine_button(self, true);
    (void)machine_button(other, true);
    show(self, machine_advance(self, 170 * MS, 1000U), &devices);
    show(other, machine_advance(other, 170 * MS, 1000U), &other_devices);
    copy.bytes[MACHINE_SIZE / 2U] ^= 1U;
    (void)printf("damaged %d", machine_restore(self, &copy));
    (void)memset(&copy, 0, sizeof copy);
    (void)printf(", of another build %d", machine_restore(self, &copy));
    (void)memset(&other_memory, 0, sizeof other_memory);
    machine_save((const machine_instance *)(const void *)&other_memory, &copy);
    (void)printf(", of no instance %d\n", machine_restore(self, &copy));
}

/* A copy in a file, for another process. */
static void keep(void)
{
    static machine_memory copy;
    machine_instance *const self = begin(&memory, &devices, false);
    (void)machine_advance(self, 50 * MS, 1000U);
    machine_save(self, &copy);
    (void)fwrite(&copy, sizeof copy, 1U, stdout);
}

/* Continues from the file, at another address, in an instance whose run has failed. */
static void resume(void)
{
    static machine_memory copy;
    machine_instance *const self = begin(&other_memory, &other_devices, true);
    (void)machine_advance(self, 3 * MS, 1000U);
    show(self, machine_advance(self, 10 * MS, 1000U), &other_devices);
    other_devices = devices;
    const bool whole = fread(&copy, sizeof copy, 1U, stdin) == 1U;
    (void)printf("whole %d, restored %d", whole, machine_restore(self, &copy));
    (void)printf(", next %lld\n", (long long)(machine_next(self) / MS));
    for (int64_t now = 51; now < 60; now++) {
        (void)machine_advance(self, now * MS, 1000U);
    }
    show(self, machine_advance(self, 60 * MS, 1000U), &other_devices);
    (void)machine_button(self, true);
    show(self, machine_advance(self, 60 * MS, 1000U), &other_devices);
    machine_save(self, &copy);
    machine_instance *const driving = begin(&memory, &devices, false);
    (void)machine_advance(driving, 10 * MS, 1000U);
    (void)printf("of a run that has ended %d", machine_restore(driving, &copy));
    (void)printf(", released %d, state %d\n", devices.released, (int)machine_advance(driving, 70 * MS, 1000U));
}

static bool poll(void *context, machine_event event, void *value)
{
    plant *const self = context;
    (void)event;
    self->polls++;
    *(bool *)value = true;
    return self->pressed;
}

/* As a simulator does it that exchanges values each 3 ms: instants before the end of a step, what the outputs have for the end, nothing else of the end. */
static void exchange(void)
{
    machine_hooks hooks = hooks_of(&devices);
    hooks.poll = poll;
    hooks.grid = 3 * MS;
    machine_instance *const self = machine_begin(&memory, sizeof memory, &hooks, NULL);
    for (int64_t end = 3 * MS; end <= 9 * MS; end += 3 * MS) {
        const machine_state state = machine_advance(self, end - 1, 1000U);
        machine_hand_over(self, end);
        (void)printf("%lld ms: state %d, samples %d, drive %g, polls %d\n", (long long)(end / MS), (int)state,
                     devices.samples, devices.last.drive, devices.polls);
    }
    machine_hand_over(self, 20 * MS);
    (void)printf("too early: drive %g\n", devices.last.drive);
    devices.pressed = true;
    const machine_state state = machine_advance(self, 9 * MS, 1000U);
    (void)printf("state %d, lamp %d\n", (int)state, devices.last.lamp);
    show(self, state, &devices);
}

/* Late by two hundred years, with a button that is pressed meanwhile. */
static void be_very_late(void)
{
    machine_hooks hooks = hooks_of(&devices);
    hooks.real_time = true;
    machine_instance *const self = machine_begin(&memory, sizeof memory, &hooks, NULL);
    (void)machine_advance(self, 3 * MS, 1000U);
    show(self, machine_advance(self, 200 * 365 * INT64_C(86400000) * MS, 1000U), &devices);
    (void)printf("samples %d\n", devices.samples);
}

/* A counter of which every reading takes ten cycles. */
static uint32_t ten_cycles(void *context)
{
    (void)context;
    static uint32_t counter = UINT32_MAX - 100U; /* it overflows */
    counter += 10U;
    return counter;
}

static void put(void *context, const char *text)
{
    (void)fputs(text, context);
}

static void measure(void)
{
    static machine_times times;
    machine_hooks hooks = hooks_of(&devices);
    hooks.cycles = ten_cycles;
    hooks.times = &times;
    machine_instance *const self = machine_begin(&memory, sizeof memory, &hooks, NULL);
    for (int64_t now = 0; now < 100; now++) {
        (void)machine_advance(self, now * MS, 1U + (uint32_t)(now % 2));
    }
    (void)fprintf(stderr, "instant %u\n", (unsigned)times.instant);
    machine_write_times(&times, 0U, put, stdout); /* nothing */
    machine_write_times(&times, 1000000U, put, stdout);
}

static void report_failure(void *context, const machine_instance *self)
{
    const plant *const of = context;
    machine_failure failure;
    (void)printf("failed %d", machine_diagnose(self, &failure));
    (void)printf(", cause %d at %lld ms in %s, %s; released %d\n", (int)failure.cause, (long long)(failure.instant / MS),
                 failure.process, failure.place, of->released);
}

static void fail(void)
{
    machine_hooks hooks = hooks_of(&devices);
    hooks.fault = report_failure;
    machine_instance *self = machine_begin(&memory, sizeof memory, &hooks, NULL);
    (void)machine_advance(self, 5 * MS, 1000U);
    machine_failure failure;
    (void)printf("failed %d\n", machine_diagnose(self, &failure));
    devices.level = NAN;
    for (unsigned again = 0U; again < 2U; again++) {
        (void)machine_advance(self, 30 * MS, 1000U);
    }
    devices.released = 0;
    devices.level = 0.0;
    hooks.real_time = true;
    self = machine_begin(&memory, sizeof memory, &hooks, NULL);
    (void)machine_advance(self, 3 * MS, 1000U);
    (void)machine_advance(self, 10 * MS, 1000U);
}

static void traced(void *context, const machine_communication *communication)
{
    double real = 0.0;
    bool truth = false;
    (void)context;
    (void)printf("%lld us: %s %lu>%lu ", (long long)(communication->instant / 1000),
                 machine_channel_name(communication->channel), (unsigned long)communication->writer,
                 (unsigned long)communication->reader);
    if ((communication->channel == MACHINE_PORT_BUTTON) || (communication->channel == MACHINE_PORT_LAMP)) {
        (void)memcpy(&truth, communication->value, communication->size);
        (void)printf("%d\n", truth);
    } else {
        (void)memcpy(&real, communication->value, communication->size);
        (void)printf("%g\n", real);
    }
}

static void trace(void)
{
    machine_hooks hooks = hooks_of(&devices);
    const char *reason = NULL;
    hooks.trace = traced;
    machine_instance *const self = machine_begin(&memory, sizeof memory, &hooks, &reason);
    if (self == NULL) {
        (void)printf("%s\n", reason);
        return;
    }
    (void)machine_advance(self, 5 * MS, 1000U);
    (void)machine_button(self, true);
    (void)machine_advance(self, 10 * MS, 1000U);
    (void)printf("process %s, no channel \"%s\", no process \"%s\"\n", machine_process_name(1U),
                 machine_channel_name(99U), machine_process_name(99U));
}

int main(int count, char **arguments)
{
    static const struct {
        const char *name;
        void (*run)(void);
    } parts[] = {{"refuse", refuse}, {"run", run}, {"reset", reset}, {"late", be_late}, {"bad", sample_badly},
                 {"restore", restore}, {"exchange", exchange}, {"keep", keep}, {"resume", resume}, {"measure", measure}, {"very late", be_very_late},
                 {"fail", fail}, {"trace", trace}};
    for (size_t index = 0U; index < sizeof parts / sizeof parts[0]; index++) {
        if ((count > 1) && (strcmp(arguments[1], parts[index].name) == 0)) {
            parts[index].run();
        }
    }
    return 0;
}
