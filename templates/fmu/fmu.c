/* See fmu.h: what is the same in both versions of FMI. */
#include "fmu.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct fmu_state {
    int64_t now;
    double start;
    int32_t phase;
    int32_t said_end;
    char token[64];
    double model[]; /* bytes, aligned */
};

/* ---- Messages ---- */

bool fmu_fail(fmu_instance *self, const char *message)
{
    self->logger(self, FMU_ERROR_MESSAGE, message);
    return false;
}

static bool fail_of_phase(fmu_instance *self, const char *function)
{
    static const char *const names[] = {"instantiated", "in initialization mode", "in step mode",
                                        "in event mode", "terminated", "in an error"};
    char text[FMU_TEXT] = "";
    (void)snprintf(text, sizeof text, "%s cannot be called while the instance is %s", function, names[self->phase]);
    return fmu_fail(self, text);
}

bool fmu_is_allowed(fmu_instance *self, unsigned phases, const char *function)
{
    return (((1U << (unsigned)self->phase) & phases) != 0U) || fail_of_phase(self, function);
}

/* The model has failed: its outputs have their safe values, and it stays so until a reset. */
static bool fail_of_model(fmu_instance *self)
{
    char text[FMU_TEXT] = "";
    (void)snprintf(text, sizeof text, "failed in the step from %.9g s: ", fmu_time(self));
    const size_t length = strlen(text);
    fmu_describe(self->model, text + length, sizeof text - length);
    self->phase = FMU_FAILED;
    return fmu_fail(self, text);
}

static void tell_end(fmu_instance *self)
{
    if (!self->said_end && fmu_has_ended(self->model)) {
        self->said_end = true;
        if (self->logs_events) {
            self->logger(self, FMU_EVENT_MESSAGE, "ended by itself; its outputs keep their safe values");
        }
    }
}

/* ---- Life ---- */

fmu_instance *fmu_instantiate(const fmu_instance *described, const char *name, const char *token)
{
    fmu_instance *const self = malloc(sizeof *self);
    if (self == NULL) {
        return NULL;
    }
    *self = *described;
    const size_t size = strlen((name != NULL) ? name : "") + 1U;
    self->name = malloc(size);
    self->model = fmu_create();
    if (self->name != NULL) {
        (void)memcpy(self->name, (name != NULL) ? name : "", size);
    }
    if ((self->name == NULL) || (self->model == NULL)) {
        (void)fmu_fail(self, "there is no memory left");
    } else if ((token == NULL) || (strcmp(token, fmu_token) != 0)) {
        (void)fmu_fail(self, "the guid, or instantiation token, is that of another FMU: modelDescription.xml and binary do not belong together");
    } else {
        return self;
    }
    fmu_free(self);
    return NULL;
}

void fmu_free(fmu_instance *self)
{
    if (self != NULL) {
        if ((self->model != NULL) && (self->phase != FMU_INSTANTIATED)) {
            fmu_finish(self->model);
        }
        free(self->model);
        free(self->name);
        free(self);
    }
}

bool fmu_initialize(fmu_instance *self, double start)
{
    self->start = start;
    self->now = 0;
    self->phase = FMU_INITIALIZING;
    return fmu_begin(self->model) || fail_of_model(self);
}

bool fmu_initialized(fmu_instance *self)
{
    self->phase = self->has_event_mode ? FMU_IN_EVENT : FMU_STEPPING;
    return fmu_begin(self->model) || fail_of_model(self);
}

bool fmu_reset(fmu_instance *self)
{
    fmu_model *const fresh = fmu_create();
    if (fresh == NULL) {
        return fmu_fail(self, "there is no memory left");
    }
    if (self->phase != FMU_INSTANTIATED) {
        fmu_finish(self->model);
    }
    free(self->model);
    self->model = fresh;
    self->phase = FMU_INSTANTIATED;
    self->said_end = false;
    self->start = 0.0;
    self->now = 0;
    return true;
}

bool fmu_terminate(fmu_instance *self)
{
    fmu_finish(self->model);
    self->phase = FMU_TERMINATED;
    return true;
}

/* ---- Time ---- */

double fmu_time_of(const fmu_instance *self, int64_t instant)
{
    return self->start + (double)instant / FMU_NANOSECONDS;
}

double fmu_time(const fmu_instance *self)
{
    return fmu_time_of(self, self->now);
}

/* The end of a step in nanoseconds. Simulators add up their steps, so their time is a little off; the sum of the lengths is exact, unless those are no whole
 * nanoseconds: then the time counts as soon as it differs. */
static int64_t end_of_step(const fmu_instance *self, double time, double length)
{
    const int64_t by_length = self->now + (int64_t)llrint(length * FMU_NANOSECONDS);
    const int64_t by_time = (int64_t)llrint((time - self->start + length) * FMU_NANOSECONDS);
    const int64_t difference = (by_time > by_length) ? by_time - by_length : by_length - by_time;
    return (difference <= (10 + by_time / INT64_C(10000000000))) ? by_length : by_time;
}

static bool fail_of_step(fmu_instance *self, double time, double length)
{
    char text[FMU_TEXT] = "";
    (void)snprintf(text, sizeof text, "a step of %g s from %.9g s is not possible: the instance is at %.9g s", length, time,
                   fmu_time(self));
    return fmu_fail(self, text);
}

bool fmu_step(fmu_instance *self, double time, double length, bool stops)
{
    const double longest = 9.2e9;
    if (!(length >= 0.0) || !(length < longest) || !(fabs(time - self->start) < longest)) {
        return fail_of_step(self, time, length);
    }
    int64_t end = end_of_step(self, time, length);
    if ((end < self->now) || (fabs(time - fmu_time(self)) > (1e-6 + 1e-9 * fabs(time)))) {
        return fail_of_step(self, time, length);
    }
    if (stops && fmu_takes_samples) {
        if (!fmu_meet(self->model, self->now)) {
            return fail_of_model(self);
        }
        const int64_t next = fmu_next(self->model);
        end = (next < end) ? next : end;
    }
    if (!fmu_advance(self->model, end)) {
        return fail_of_model(self);
    }
    self->now = end;
    tell_end(self);
    return true;
}

bool fmu_update(fmu_instance *self)
{
    if (!fmu_meet(self->model, self->now)) {
        return fail_of_model(self);
    }
    tell_end(self);
    return true;
}

/* ---- States ---- */

size_t fmu_state_size(void)
{
    return sizeof(fmu_state) + fmu_saved_size;
}

fmu_state *fmu_get_state(fmu_instance *self, fmu_state *into)
{
    fmu_state *const state = (into != NULL) ? into : calloc(1U, fmu_state_size());
    if (state == NULL) {
        (void)fmu_fail(self, "there is no memory left");
        return NULL;
    }
    state->now = self->now;
    state->start = self->start;
    state->phase = (int32_t)self->phase;
    state->said_end = self->said_end ? 1 : 0;
    (void)strncpy(state->token, fmu_token, sizeof state->token - 1U);
    fmu_save(self->model, state->model);
    return state;
}

bool fmu_set_state(fmu_instance *self, const fmu_state *state)
{
    if ((state == NULL) || (strncmp(state->token, fmu_token, sizeof state->token) != 0)
        || (state->phase < (int32_t)FMU_INSTANTIATED) || (state->phase > (int32_t)FMU_FAILED)
        || !fmu_restore(self->model, state->model)) {
        return fmu_fail(self, "the state is not one of this FMU");
    }
    self->now = state->now;
    self->start = state->start;
    self->phase = (fmu_phase)state->phase;
    self->said_end = state->said_end != 0;
    return true;
}

void fmu_free_state(fmu_state *state)
{
    free(state);
}

bool fmu_write_state(fmu_instance *self, const fmu_state *state, unsigned char *bytes, size_t size)
{
    if ((state == NULL) || (size < fmu_state_size())) {
        return fmu_fail(self, "there is no state, or no room for it");
    }
    (void)memcpy(bytes, state, fmu_state_size());
    return true;
}

fmu_state *fmu_read_state(fmu_instance *self, const unsigned char *bytes, size_t size)
{
    fmu_state *const state = (size == fmu_state_size()) ? calloc(1U, size) : NULL;
    if (state == NULL) {
        (void)fmu_fail(self, "these bytes are not a state of this FMU");
        return NULL;
    }
    (void)memcpy(state, bytes, size);
    return state;
}
