/* See csp_fmu_library.h: model exchange, by Euler's or the classical Runge-Kutta method, with events located by bisection. */
#include "csp_fmu_library.h"

#include <math.h>
#include <string.h>

enum { MOST_EVENTS = 1000 /* in a step */, MOST_UPDATES = 1000 /* at an event */, BISECTIONS = 48 };

typedef int vector_function(void *c, double *values, size_t count);

/* fmi2EventInfo */
typedef struct event_info {
    int again;
    int terminates;
    int nominals;
    int states;
    int has_next;
    double next;
} event_info;

bool csp_fmu_handle_event(csp_fmu *self, double time)
{
    event_info info = {1, 0, 0, 0, 0, 0.0};
    for (int updates = 0; info.again != 0; updates++) {
        if (updates == (int)MOST_UPDATES) {
            return csp_fmu_fail(self, "has updated its discrete states %d times at the event of %.9g s; it does not get any further",
                                (int)MOST_UPDATES, time);
        }
        int status = CSP_FMU_ERROR;
        if (self->facts->is_new) {
            int (*update)(void *, bool *, bool *, bool *, bool *, bool *, double *) = NULL;
            bool flags[5] = {false, false, false, false, false};
            *(void **)&update = csp_fmu_function(self, "UpdateDiscreteStates");
            status = (update == NULL) ? (int)CSP_FMU_ERROR
                                      : update(self->library->component, &flags[0], &flags[1], &flags[2], &flags[3],
                                               &flags[4], &info.next);
            info.again = flags[0] ? 1 : 0;
            info.terminates = flags[1] ? 1 : 0;
            info.has_next = flags[4] ? 1 : 0;
        } else {
            int (*update)(void *, event_info *) = NULL;
            *(void **)&update = csp_fmu_function(self, "NewDiscreteStates");
            status = (update == NULL) ? (int)CSP_FMU_ERROR : update(self->library->component, &info);
        }
        if (!csp_fmu_is_fine(self, status, self->facts->is_new ? "UpdateDiscreteStates" : "NewDiscreteStates", time)) {
            return false;
        }
        if (info.terminates != 0) {
            return csp_fmu_has_ended(self, time);
        }
    }
    self->next_event = (info.has_next != 0) ? info.next : (double)INFINITY;
    return csp_fmu_call(self, "EnterContinuousTimeMode", time);
}

static bool go_to(csp_fmu *self, double time, double *states)
{
    int (*set_time)(void *, double) = NULL;
    vector_function *set_states = NULL;
    *(void **)&set_time = csp_fmu_function(self, "SetTime");
    *(void **)&set_states = csp_fmu_function(self, "SetContinuousStates");
    if ((set_time == NULL) || (set_states == NULL)) {
        return csp_fmu_fail(self, "has no functions for model exchange");
    }
    return csp_fmu_is_fine(self, set_time(self->library->component, time), "SetTime", time)
        && ((self->facts->states == 0U)
            || csp_fmu_is_fine(self, set_states(self->library->component, states, self->facts->states), "SetContinuousStates", time));
}

static bool get_vector(csp_fmu *self, const char *function, double *values, size_t count, double time)
{
    vector_function *found = NULL;
    if (count == 0U) {
        return true;
    }
    *(void **)&found = csp_fmu_function(self, function);
    return (found != NULL) ? csp_fmu_is_fine(self, found(self->library->component, values, count), function, time)
                           : csp_fmu_fail(self, "has no function %s", function);
}

static bool slopes(csp_fmu *self, double time, double *states, double *into)
{
    const char *const name = self->facts->is_new ? "GetContinuousStateDerivatives" : "GetDerivatives";
    return go_to(self, time, states) && get_vector(self, name, into, self->facts->states, time);
}

static bool signs(csp_fmu *self, double time, bool *into)
{
    double *const found = self->library->indicators;
    if (!get_vector(self, "GetEventIndicators", found, self->facts->indicators, time)) {
        return false;
    }
    for (size_t index = 0U; index < self->facts->indicators; index++) {
        into[index] = found[index] > 0.0;
    }
    return true;
}

/* Moves the states from `x` to `moved`, in the order of operations of environments. */
static bool move(csp_fmu *self, double time, double h)
{
    struct csp_fmu_library *const library = self->library;
    const double half = h / 2.0;
    const double sixth = h / 6.0;
    const double at[4] = {time, time + half, time + half, time + h};
    const double part[4] = {0.0, half, half, h};
    const size_t count = self->facts->states;
    double *const moved = library->moved;
    const size_t stages = self->facts->is_euler ? 1U : 4U;
    for (size_t stage = 0U; stage < stages; stage++) {
        for (size_t index = 0U; index < count; index++) {
            moved[index] = (stage == 0U) ? library->x[index]
                                         : library->x[index] + part[stage] * library->k[stage - 1U][index];
        }
        if (!slopes(self, at[stage], moved, library->k[stage])) {
            return false;
        }
    }
    for (size_t index = 0U; index < count; index++) {
        if (self->facts->is_euler) {
            moved[index] = library->x[index] + h * library->k[0][index];
        } else {
            moved[index] = library->x[index]
                + sixth * (library->k[0][index] + 2.0 * library->k[1][index] + 2.0 * library->k[2][index]
                           + library->k[3][index]);
        }
    }
    return true;
}

static bool has_changed(const csp_fmu *self)
{
    const struct csp_fmu_library *const library = self->library;
    return memcmp(library->before, library->after, self->facts->indicators * sizeof(bool)) != 0;
}

/* The instant just after the first event of a step; the states there are set. */
static bool locate(csp_fmu *self, double time, double length, double *found)
{
    double earlier = 0.0;
    double later = length;
    for (int round = 0; round < BISECTIONS; round++) {
        const double middle = earlier + (later - earlier) / 2.0;
        if (!((earlier < middle) && (middle < later))) {
            break;
        }
        if (!move(self, time, middle) || !go_to(self, time + middle, self->library->moved)
            || !signs(self, time + middle, self->library->after)) {
            return false;
        }
        if (has_changed(self)) {
            later = middle;
        } else {
            earlier = middle;
        }
    }
    *found = time + later;
    return move(self, time, later) && go_to(self, *found, self->library->moved) && signs(self, *found, self->library->after);
}

static bool step_completed(csp_fmu *self, double time, bool *enters)
{
    int status = CSP_FMU_ERROR;
    bool terminates = false;
    if (self->facts->is_new) {
        int (*done)(void *, bool, bool *, bool *) = NULL;
        *(void **)&done = csp_fmu_function(self, "CompletedIntegratorStep");
        status = (done == NULL) ? (int)CSP_FMU_ERROR : done(self->library->component, true, enters, &terminates);
    } else {
        int (*done)(void *, int, int *, int *) = NULL;
        int flags[2] = {0, 0};
        *(void **)&done = csp_fmu_function(self, "CompletedIntegratorStep");
        status = (done == NULL) ? (int)CSP_FMU_ERROR : done(self->library->component, 1, &flags[0], &flags[1]);
        *enters = flags[0] != 0;
        terminates = flags[1] != 0;
    }
    return csp_fmu_is_fine(self, status, "CompletedIntegratorStep", time) && (!terminates || csp_fmu_has_ended(self, time));
}

bool csp_fmu_integrate(csp_fmu *self, double end)
{
    const double begin = self->time;
    const double longest = (double)self->facts->step / 1e9;
    const double wanted = (self->facts->step > 0) ? ceil((end - begin) / longest - 1e-9) : 1.0;
    const double count = (wanted > 1.0) ? wanted : 1.0;
    const double h = (end - begin) / count;
    double number = 1.0;
    double time = begin;
    int events = 0;
    while (time < end) {
        const double grid = (number < count) ? begin + number * h : end;
        bool enters = false;
        if (time >= grid) {
            number += 1.0;
            continue;
        }
        if (events > MOST_EVENTS) {
            return csp_fmu_fail(self, "has more than %d events in the step to %.9g s", (int)MOST_EVENTS, end);
        }
        double target = (self->next_event < grid) ? self->next_event : grid;
        bool is_event = target == self->next_event;
        if (!get_vector(self, "GetContinuousStates", self->library->x, self->facts->states, time)
            || !signs(self, time, self->library->before) || !move(self, time, target - time)
            || !go_to(self, target, self->library->moved) || !signs(self, target, self->library->after)) {
            return false;
        }
        if (has_changed(self)) {
            is_event = true;
            if (!locate(self, time, target - time, &target)) {
                return false;
            }
        }
        time = target;
        if (!step_completed(self, time, &enters)) {
            return false;
        }
        if (is_event || enters) {
            events++;
            if (!csp_fmu_call(self, "EnterEventMode", time) || !csp_fmu_handle_event(self, time)) {
                return false;
            }
        }
    }
    return true;
}
