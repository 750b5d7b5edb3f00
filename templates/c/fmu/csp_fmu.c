/* See csp_fmu.h. */
#include "csp_fmu_library.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char reported[2 * CSP_FMU_TEXT + 200];

static void describe(const csp_operands *operands, char *text, size_t size)
{
    (void)operands;
    (void)snprintf(text, size, "%s", reported);
}

void csp_fmu_initialize(csp_fmu *self, const csp_fmu_facts *facts)
{
    if (self->library != NULL) {
        csp_fmu_unload(self->library, self->facts->is_new);
    }
    (void)memset(self, 0, sizeof *self);
    self->facts = facts;
    self->next_event = (double)INFINITY;
    self->library = calloc(1U, sizeof *self->library);
    if (self->library != NULL) {
        (void)csp_fmu_load(self);
    }
}

static bool enter_initialization(csp_fmu *self, double time)
{
    if (self->facts->is_new) {
        int (*enter)(void *, bool, double, double, bool, double) = NULL;
        *(void **)&enter = csp_fmu_function(self, "EnterInitializationMode");
        return (enter != NULL) && csp_fmu_is_fine(self, enter(self->library->component, false, 0.0, time, false, 0.0),
                                          "EnterInitializationMode", time);
    }
    return csp_fmu_call(self, "EnterInitializationMode", time);
}

static bool set_up(csp_fmu *self, double time)
{
    int (*found)(void *, int, double, double, int, double) = NULL;
    *(void **)&found = csp_fmu_function(self, "SetupExperiment");
    return (found != NULL) && csp_fmu_is_fine(self, found(self->library->component, 0, 0.0, time, 0, 0.0), "SetupExperiment", time);
}

static bool differs(csp_fmu *self, size_t index, const void *ports)
{
    const csp_fmu_port *const port = &self->facts->inputs[index];
    return memcmp(&self->library->given[index], (const char *)ports + port->offset, csp_fmu_size_of(port->member)) != 0;
}

static bool give_changed(csp_fmu *self, const void *ports)
{
    bool is_event = false;
    for (size_t index = 0U; index < self->facts->input_count; index++) {
        is_event = is_event || (self->facts->inputs[index].is_discrete && differs(self, index, ports));
    }
    if (is_event && !csp_fmu_call(self, "EnterEventMode", self->time)) {
        return false;
    }
    for (size_t index = 0U; index < self->facts->input_count; index++) {
        if (differs(self, index, ports)
            && !csp_fmu_set(self, self->library->setters[index], &self->facts->inputs[index], ports, self->time)) {
            return false;
        }
    }
    return !is_event || csp_fmu_handle_event(self, self->time);
}

static bool step(csp_fmu *self, double length)
{
    int status = CSP_FMU_ERROR;
    bool flags[3] = {false, false, false}; /* an event is to be handled, the simulation is over, the step ended early */
    if (self->facts->is_new) {
        int (*found)(void *, double, double, bool, bool *, bool *, bool *, double *) = NULL;
        double reached = 0.0;
        *(void **)&found = csp_fmu_function(self, "DoStep");
        status = (found == NULL) ? (int)CSP_FMU_ERROR
                                 : found(self->library->component, self->time, length, true, &flags[0], &flags[1], &flags[2],
                                         &reached);
    } else {
        int (*found)(void *, double, double, int) = NULL;
        *(void **)&found = csp_fmu_function(self, "DoStep");
        status = (found == NULL) ? (int)CSP_FMU_ERROR : found(self->library->component, self->time, length, 1);
    }
    return csp_fmu_is_fine(self, status, "DoStep", self->time) && (!flags[1] || csp_fmu_has_ended(self, self->time + length));
}

/* An enumeration that still is 0, which is none of its numbers: nobody has written it, and the FMU has a value for that. */
static bool is_unwritten(csp_fmu *self, size_t index, const void *ports)
{
    static const csp_fmu_value zero;
    const csp_fmu_port *const port = &self->facts->inputs[index];
    return port->lacks_zero && !differs(self, index, ports)
        && (memcmp(&self->library->given[index], &zero, csp_fmu_size_of(port->member)) == 0);
}

static bool set_inputs(csp_fmu *self, const void *ports, double time)
{
    for (size_t index = 0U; index < self->facts->input_count; index++) {
        if (!is_unwritten(self, index, ports)
            && !csp_fmu_set(self, self->library->setters[index], &self->facts->inputs[index], ports, time)) {
            return false;
        }
    }
    return true;
}

static bool begin(csp_fmu *self, const void *ports, double time)
{
    const csp_fmu_facts *const facts = self->facts;
    self->is_begun = true;
    return (facts->is_new || set_up(self, time)) && csp_fmu_set_all(self, facts->parameters, facts->parameter_count, ports, time)
        && enter_initialization(self, time) && set_inputs(self, ports, time)
        && csp_fmu_call(self, "ExitInitializationMode", time) && (!facts->is_model_exchange || csp_fmu_handle_event(self, time));
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
        is_done = give_changed(self, ports) && csp_fmu_integrate(self, time);
    } else {
        is_done = set_inputs(self, ports, self->time) && step(self, time - self->time);
    }
    self->time = time;
    for (size_t index = 0U; index < facts->input_count; index++) {
        (void)memcpy(&self->library->given[index], (const char *)ports + facts->inputs[index].offset,
                     csp_fmu_size_of(facts->inputs[index].member));
    }
    return is_done && csp_fmu_get_outputs(self, ports, time);
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
