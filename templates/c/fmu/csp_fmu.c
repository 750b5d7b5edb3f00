/* See csp_fmu.h. */
#define _POSIX_C_SOURCE 200809L
#include "csp_fmu.h"

#include <dlfcn.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT = 1024, MOST_EVENTS = 1000, BISECTIONS = 48, FMI_DISCARD = 2, KNOWN = 24 };

typedef int access_function(void *c, const uint32_t *references, size_t count, void *values);
typedef int access3_function(void *c, const uint32_t *references, size_t count, void *values, size_t value_count);
typedef int plain_function(void *c);
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

/* fmi2CallbackFunctions */
typedef struct callbacks {
    void (*logger)(void *environment, const char *name, int status, const char *category, const char *message, ...);
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
    void (*finished)(void *environment, int status);
    void *environment;
} callbacks;

struct csp_fmu_library {
    void *handle;
    void *component;
    callbacks functions;
    char message[TEXT]; /* the last of the FMU */
    char failure[2 * TEXT + 200];
    void **getters; /* of outputs */
    void **setters; /* of inputs */
    unsigned char *given; /* the inputs that were set last, 8 bytes each */
    double *x, *moved, *k[4];
    bool *before, *after;
    double *indicators;
    struct {
        const char *name;
        void *function;
    } known[KNOWN]; /* functions that have been looked for */
};

/* ---- Failures ---- */

static char reported[2 * TEXT + 200];

static void describe(const csp_operands *operands, char *text, size_t size)
{
    (void)operands;
    (void)snprintf(text, size, "%s", reported);
}

static bool fail(csp_fmu *self, const char *format, ...)
{
    struct csp_fmu_library *const library = self->library;
    char text[TEXT] = "";
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (library->failure[0] == '\0') {
        const bool has_message = library->message[0] != '\0';
        (void)snprintf(library->failure, sizeof library->failure, "%s %s%s%s", self->facts->name, text, has_message ? ": " : "",
                       library->message);
    }
    return false;
}

static void log2_message(void *environment, const char *name, int status, const char *category, const char *message, ...)
{
    struct csp_fmu_library *const library = environment;
    va_list arguments;
    (void)name;
    (void)status;
    (void)category;
    va_start(arguments, message);
    (void)vsnprintf(library->message, sizeof library->message, (message != NULL) ? message : "", arguments);
    va_end(arguments);
}

static void log3_message(void *environment, int status, const char *category, const char *message)
{
    struct csp_fmu_library *const library = environment;
    (void)status;
    (void)category;
    (void)snprintf(library->message, sizeof library->message, "%s", (message != NULL) ? message : "");
}

/* ---- Functions of the library ---- */

static void *find(const csp_fmu *self, const char *action, const char *name)
{
    char text[80] = "";
    (void)snprintf(text, sizeof text, "fmi%d%s%s", self->facts->is_new ? 3 : 2, action, name);
    return dlsym(self->library->handle, text);
}

/* A function whose name, a literal, is the same in each call. */
static void *function_of(csp_fmu *self, const char *name)
{
    struct csp_fmu_library *const library = self->library;
    size_t index = 0U;
    while ((index < (KNOWN - 1U)) && (library->known[index].name != NULL)) {
        if (library->known[index].name == name) {
            return library->known[index].function;
        }
        index++;
    }
    library->known[index].name = name;
    library->known[index].function = find(self, name, "");
    return library->known[index].function;
}

/* `status` is what the function of this name has returned. */
static bool is_fine(csp_fmu *self, int status, const char *function, double time)
{
    static const char *const words[] = {"", "", "discard", "an error", "a fatal error"};
    if (status < FMI_DISCARD) {
        self->library->message[0] = '\0';
        return true;
    }
    return fail(self, "returned %s in fmi%d%s, at %.9g s", words[(status < 5) ? status : 3], self->facts->is_new ? 3 : 2,
                function, time);
}

static bool call(csp_fmu *self, const char *function, double time)
{
    plain_function *found = NULL;
    *(void **)&found = function_of(self, function);
    return (found != NULL) ? is_fine(self, found(self->library->component), function, time)
                           : fail(self, "has no function %s", function);
}

/* ---- Values ---- */

typedef union value {
    double f64;
    float f32;
    int8_t i8;
    uint8_t u8;
    int16_t i16;
    uint16_t u16;
    int32_t i32;
    uint32_t u32;
    int64_t i64;
    bool b;
    int boolean;
} value;

static bool is_real(csp_fmu_type type)
{
    return (type == CSP_FMU_FLOAT64) || (type == CSP_FMU_FLOAT32);
}

static double real_of(const value *from, csp_fmu_type type)
{
    return (type == CSP_FMU_FLOAT32) ? (double)from->f32 : from->f64;
}

static int64_t integer_of(const value *from, csp_fmu_type type)
{
    switch (type) {
    case CSP_FMU_INT8: return from->i8;
    case CSP_FMU_UINT8: return from->u8;
    case CSP_FMU_INT16: return from->i16;
    case CSP_FMU_UINT16: return from->u16;
    case CSP_FMU_INT32: return from->i32;
    case CSP_FMU_UINT32: return from->u32;
    case CSP_FMU_BOOL: return from->b ? 1 : 0;
    case CSP_FMU_BOOLEAN: return (from->boolean != 0) ? 1 : 0;
    default: return from->i64;
    }
}

static void store_integer(value *to, csp_fmu_type type, int64_t number)
{
    switch (type) {
    case CSP_FMU_INT8: to->i8 = (int8_t)number; break;
    case CSP_FMU_UINT8: to->u8 = (uint8_t)number; break;
    case CSP_FMU_INT16: to->i16 = (int16_t)number; break;
    case CSP_FMU_UINT16: to->u16 = (uint16_t)number; break;
    case CSP_FMU_INT32: to->i32 = (int32_t)number; break;
    case CSP_FMU_UINT32: to->u32 = (uint32_t)number; break;
    case CSP_FMU_BOOL: to->b = number != 0; break;
    case CSP_FMU_BOOLEAN: to->boolean = (int)number; break;
    default: to->i64 = number; break;
    }
}

static size_t size_of(csp_fmu_type type)
{
    static const size_t sizes[] = {8U, 4U, 1U, 1U, 2U, 2U, 4U, 4U, 8U, sizeof(bool), sizeof(int)};
    return sizes[type];
}

static void convert(const value *from, csp_fmu_type old, value *to, csp_fmu_type type)
{
    if (!is_real(old)) {
        store_integer(to, type, integer_of(from, old));
    } else if (type == CSP_FMU_FLOAT32) {
        to->f32 = (float)real_of(from, old);
    } else {
        to->f64 = real_of(from, old);
    }
}

static bool access_value(csp_fmu *self, void *function, const csp_fmu_port *port, value *of, const char *action, double time)
{
    int status = FMI_DISCARD;
    if (function == NULL) {
        return fail(self, "has no function %s%s", action, port->functions);
    }
    if (self->facts->is_new) {
        access3_function *found = NULL;
        *(void **)&found = function;
        status = found(self->library->component, &port->reference, 1U, of, 1U);
    } else {
        access_function *found = NULL;
        *(void **)&found = function;
        status = found(self->library->component, &port->reference, 1U, of);
    }
    return is_fine(self, status, action, time);
}

static bool set(csp_fmu *self, void *function, const csp_fmu_port *port, const void *ports, double time)
{
    value member = {0};
    value given = {0};
    (void)memcpy(&member, (const char *)ports + port->offset, size_of(port->member));
    convert(&member, port->member, &given, port->type);
    return access_value(self, function, port, &given, "Set", time);
}

static bool set_all(csp_fmu *self, const csp_fmu_port *table, size_t count, const void *ports, double time)
{
    for (size_t index = 0U; index < count; index++) {
        if (!set(self, find(self, "Set", table[index].functions), &table[index], ports, time)) {
            return false;
        }
    }
    return true;
}

static bool get_outputs(csp_fmu *self, void *ports, double time)
{
    for (size_t index = 0U; index < self->facts->output_count; index++) {
        const csp_fmu_port *const port = &self->facts->outputs[index];
        value taken = {0};
        value member = {0};
        if (!access_value(self, self->library->getters[index], port, &taken, "Get", time)) {
            return false;
        }
        convert(&taken, port->type, &member, port->member);
        (void)memcpy((char *)ports + port->offset, &member, size_of(port->member));
    }
    return true;
}

/* ---- Life ---- */

static bool instantiate2(csp_fmu *self)
{
    void *(*make)(const char *, int, const char *, const char *, const callbacks *, int, int) = NULL;
    struct csp_fmu_library *const library = self->library;
    const callbacks functions = {log2_message, calloc, free, NULL, library};
    library->functions = functions;
    *(void **)&make = function_of(self, "Instantiate");
    if (make != NULL) {
        library->component = make(self->facts->instance, self->facts->is_model_exchange ? 0 : 1, self->facts->token,
                                  self->facts->resources, &library->functions, 0, 0);
    }
    return (library->component != NULL) || fail(self, "cannot be instantiated");
}

typedef void log3_function(void *environment, int status, const char *category, const char *message);

static bool instantiate3(csp_fmu *self)
{
    struct csp_fmu_library *const library = self->library;
    const csp_fmu_facts *const facts = self->facts;
    if (facts->is_model_exchange) {
        void *(*make)(const char *, const char *, const char *, bool, bool, void *, log3_function *) = NULL;
        *(void **)&make = function_of(self, "InstantiateModelExchange");
        if (make != NULL) {
            library->component = make(facts->instance, facts->token, facts->resources, false, false, library, log3_message);
        }
    } else {
        void *(*make)(const char *, const char *, const char *, bool, bool, bool, bool, const uint32_t *, size_t, void *,
                      log3_function *, void *) = NULL;
        *(void **)&make = function_of(self, "InstantiateCoSimulation");
        if (make != NULL) {
            library->component = make(facts->instance, facts->token, facts->resources, false, false, false, false, NULL, 0U,
                                      library, log3_message, NULL);
        }
    }
    return (library->component != NULL) || fail(self, "cannot be instantiated");
}

static void *room(size_t count, size_t size)
{
    return calloc((count > 0U) ? count : 1U, size);
}

static bool load(csp_fmu *self)
{
    struct csp_fmu_library *const library = self->library;
    const csp_fmu_facts *const facts = self->facts;
    library->handle = dlopen(facts->library, RTLD_NOW | RTLD_LOCAL);
    if (library->handle == NULL) {
        return fail(self, "cannot be loaded: its binary is damaged, or needs a library that is not here (fmpy compile makes another): %s", dlerror());
    }
    library->getters = room(facts->output_count, sizeof *library->getters);
    library->setters = room(facts->input_count, sizeof *library->setters);
    library->given = room(facts->input_count, sizeof(value));
    library->x = room(facts->states, sizeof(double));
    library->moved = room(facts->states, sizeof(double));
    for (size_t index = 0U; index < 4U; index++) {
        library->k[index] = room(facts->states, sizeof(double));
    }
    library->indicators = room(facts->indicators, sizeof(double));
    library->before = room(facts->indicators, sizeof(bool));
    library->after = room(facts->indicators, sizeof(bool));
    for (size_t index = 0U; index < facts->output_count; index++) {
        library->getters[index] = find(self, "Get", facts->outputs[index].functions);
    }
    for (size_t index = 0U; index < facts->input_count; index++) {
        library->setters[index] = find(self, "Set", facts->inputs[index].functions);
    }
    return facts->is_new ? instantiate3(self) : instantiate2(self);
}

/* The instances of this process; they end with it. */
static void unload(struct csp_fmu_library *library, bool is_new)
{
    void (*end)(void *) = NULL;
    if ((library->handle != NULL) && (library->component != NULL)) {
        *(void **)&end = dlsym(library->handle, is_new ? "fmi3FreeInstance" : "fmi2FreeInstance");
        if (end != NULL) {
            end(library->component);
        }
    }
    free(library->getters);
    free(library->setters);
    free(library->given);
    free(library->x);
    free(library->moved);
    for (size_t index = 0U; index < 4U; index++) {
        free(library->k[index]);
    }
    free(library->indicators);
    free(library->before);
    free(library->after);
    free(library);
}

void csp_fmu_initialize(csp_fmu *self, const csp_fmu_facts *facts)
{
    if (self->library != NULL) {
        unload(self->library, self->facts->is_new);
    }
    (void)memset(self, 0, sizeof *self);
    self->facts = facts;
    self->next_event = (double)INFINITY;
    self->library = calloc(1U, sizeof *self->library);
    if (self->library != NULL) {
        (void)load(self);
    }
}

static bool enter_initialization(csp_fmu *self, double time)
{
    if (self->facts->is_new) {
        int (*enter)(void *, bool, double, double, bool, double) = NULL;
        *(void **)&enter = function_of(self, "EnterInitializationMode");
        return (enter != NULL) && is_fine(self, enter(self->library->component, false, 0.0, time, false, 0.0),
                                          "EnterInitializationMode", time);
    }
    return call(self, "EnterInitializationMode", time);
}

static bool set_up(csp_fmu *self, double time)
{
    int (*found)(void *, int, double, double, int, double) = NULL;
    *(void **)&found = function_of(self, "SetupExperiment");
    return (found != NULL) && is_fine(self, found(self->library->component, 0, 0.0, time, 0, 0.0), "SetupExperiment", time);
}

/* ---- Model exchange ---- */

static bool after_event(csp_fmu *self, double time)
{
    event_info info = {1, 0, 0, 0, 0, 0.0};
    while (info.again != 0) {
        int status = FMI_DISCARD;
        if (self->facts->is_new) {
            int (*update)(void *, bool *, bool *, bool *, bool *, bool *, double *) = NULL;
            bool flags[5] = {false, false, false, false, false};
            *(void **)&update = function_of(self, "UpdateDiscreteStates");
            status = (update == NULL) ? 3
                                      : update(self->library->component, &flags[0], &flags[1], &flags[2], &flags[3],
                                               &flags[4], &info.next);
            info.again = flags[0] ? 1 : 0;
            info.terminates = flags[1] ? 1 : 0;
            info.has_next = flags[4] ? 1 : 0;
        } else {
            int (*update)(void *, event_info *) = NULL;
            *(void **)&update = function_of(self, "NewDiscreteStates");
            status = (update == NULL) ? 3 : update(self->library->component, &info);
        }
        if (!is_fine(self, status, self->facts->is_new ? "UpdateDiscreteStates" : "NewDiscreteStates", time)) {
            return false;
        }
        if (info.terminates != 0) {
            return fail(self, "has ended the simulation at %.9g s", time);
        }
    }
    self->next_event = (info.has_next != 0) ? info.next : (double)INFINITY;
    return call(self, "EnterContinuousTimeMode", time);
}

static bool go_to(csp_fmu *self, double time, double *states)
{
    int (*set_time)(void *, double) = NULL;
    vector_function *set_states = NULL;
    *(void **)&set_time = function_of(self, "SetTime");
    *(void **)&set_states = function_of(self, "SetContinuousStates");
    if ((set_time == NULL) || (set_states == NULL)) {
        return fail(self, "has no functions for model exchange");
    }
    return is_fine(self, set_time(self->library->component, time), "SetTime", time)
        && ((self->facts->states == 0U)
            || is_fine(self, set_states(self->library->component, states, self->facts->states), "SetContinuousStates", time));
}

static bool get_vector(csp_fmu *self, const char *function, double *values, size_t count, double time)
{
    vector_function *found = NULL;
    if (count == 0U) {
        return true;
    }
    *(void **)&found = function_of(self, function);
    return (found != NULL) ? is_fine(self, found(self->library->component, values, count), function, time)
                           : fail(self, "has no function %s", function);
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
    int status = 3;
    if (self->facts->is_new) {
        int (*done)(void *, bool, bool *, bool *) = NULL;
        bool terminates = false;
        *(void **)&done = function_of(self, "CompletedIntegratorStep");
        status = (done == NULL) ? 3 : done(self->library->component, true, enters, &terminates);
    } else {
        int (*done)(void *, int, int *, int *) = NULL;
        int enters_event = 0;
        int terminates = 0;
        *(void **)&done = function_of(self, "CompletedIntegratorStep");
        status = (done == NULL) ? 3 : done(self->library->component, 1, &enters_event, &terminates);
        *enters = enters_event != 0;
    }
    return is_fine(self, status, "CompletedIntegratorStep", time);
}

static bool integrate(csp_fmu *self, double end)
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
            return fail(self, "has more than %d events in the step to %.9g s", (int)MOST_EVENTS, end);
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
            if (!call(self, "EnterEventMode", time) || !after_event(self, time)) {
                return false;
            }
        }
    }
    return true;
}

/* ---- Calculation ---- */

static bool differs(csp_fmu *self, size_t index, const void *ports)
{
    const csp_fmu_port *const port = &self->facts->inputs[index];
    return memcmp(&self->library->given[index * sizeof(value)], (const char *)ports + port->offset, size_of(port->member)) != 0;
}

static bool give_changed(csp_fmu *self, const void *ports)
{
    bool is_event = false;
    for (size_t index = 0U; index < self->facts->input_count; index++) {
        is_event = is_event || (self->facts->inputs[index].is_discrete && differs(self, index, ports));
    }
    if (is_event && !call(self, "EnterEventMode", self->time)) {
        return false;
    }
    for (size_t index = 0U; index < self->facts->input_count; index++) {
        if (differs(self, index, ports)
            && !set(self, self->library->setters[index], &self->facts->inputs[index], ports, self->time)) {
            return false;
        }
    }
    return !is_event || after_event(self, self->time);
}

static bool step(csp_fmu *self, double length)
{
    int status = 3;
    if (self->facts->is_new) {
        int (*found)(void *, double, double, bool, bool *, bool *, bool *, double *) = NULL;
        bool flags[3] = {false, false, false};
        double reached = 0.0;
        *(void **)&found = function_of(self, "DoStep");
        status = (found == NULL) ? 3
                                 : found(self->library->component, self->time, length, true, &flags[0], &flags[1], &flags[2],
                                         &reached);
    } else {
        int (*found)(void *, double, double, int) = NULL;
        *(void **)&found = function_of(self, "DoStep");
        status = (found == NULL) ? 3 : found(self->library->component, self->time, length, 1);
    }
    return is_fine(self, status, "DoStep", self->time);
}

static bool begin(csp_fmu *self, const void *ports, double time)
{
    const csp_fmu_facts *const facts = self->facts;
    self->is_begun = true;
    return (facts->is_new || set_up(self, time)) && set_all(self, facts->parameters, facts->parameter_count, ports, time)
        && enter_initialization(self, time) && set_all(self, facts->inputs, facts->input_count, ports, time)
        && call(self, "ExitInitializationMode", time) && (!facts->is_model_exchange || after_event(self, time));
}

static bool set_inputs(csp_fmu *self, const void *ports)
{
    for (size_t index = 0U; index < self->facts->input_count; index++) {
        if (!set(self, self->library->setters[index], &self->facts->inputs[index], ports, self->time)) {
            return false;
        }
    }
    return true;
}

static bool calculate(csp_fmu *self, void *ports, double time)
{
    const csp_fmu_facts *const facts = self->facts;
    bool is_done = false;
    if (self->library->component == NULL) {
        return false;
    }
    if (!self->is_begun) {
        is_done = begin(self, ports, time);
    } else if (facts->is_model_exchange) {
        is_done = give_changed(self, ports) && integrate(self, time);
    } else {
        is_done = set_inputs(self, ports) && step(self, time - self->time);
    }
    self->time = time;
    for (size_t index = 0U; index < facts->input_count; index++) {
        (void)memcpy(&self->library->given[index * sizeof(value)], (const char *)ports + facts->inputs[index].offset,
                     size_of(facts->inputs[index].member));
    }
    return is_done && get_outputs(self, ports, time);
}

void csp_fmu_calculate(csp_kernel *csp, csp_fmu *self, void *ports, double time)
{
    if ((self->library == NULL) || !calculate(self, ports, time)) {
        if (csp->fault.describe == NULL) {
            (void)snprintf(reported, sizeof reported, "%s", (self->library != NULL) ? self->library->failure : "no memory");
            csp->fault.describe = describe;
        }
    }
}
