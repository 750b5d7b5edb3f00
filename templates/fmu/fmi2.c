/* FMI 2.0 for co-simulation (https://fmi-standard.org, version 2.0.5), on fmu.h. */
#include <stdlib.h>
#include <string.h>

#include "fmu.h"

/* ---- The types of the standard ---- */

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef void fmi2CallbackLogger(fmi2ComponentEnvironment, fmi2String name, fmi2Status, fmi2String category,
                                fmi2String message, ...);
typedef struct {
    fmi2CallbackLogger *logger;
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

/* ---- What both versions have ---- */

#define FMI(name) fmi2##name
#define FMI_STATE(before, after) FMI_STATE_(before, after)
#define FMI_STATE_(before, after) fmi2##before##FMUstate##after
#define FMI_READ DeSerialize
#define FMI_TEXT(name) "fmi2" #name
#define FMI_BOOLEAN fmi2Boolean
#include "fmi_common.h"

static void pass_on(const fmu_instance *self, fmu_severity severity, const char *text)
{
    fmi2CallbackLogger *const logger = (fmi2CallbackLogger *)self->log;
    const bool is_error = severity == FMU_ERROR_MESSAGE;
    char format[2 * FMU_TEXT] = ""; /* of printf, without arguments: there are simulators that do not format messages */
    size_t length = 0U;
    for (const char *next = text; (*next != '\0') && (length < (sizeof format - 2U)); next++) {
        format[length++] = *next;
        if (*next == '%') {
            format[length++] = '%';
        }
    }
    format[length] = '\0';
    if (logger != NULL) {
        logger(self->environment, (self->name != NULL) ? self->name : "", is_error ? fmi2Error : fmi2OK,
               is_error ? "logStatusError" : "logEvents", format);
    }
}

/* ---- Life ---- */

FMU_EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

FMU_EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

FMU_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                         const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean on)
{
    (void)resources;
    (void)visible;
    const fmu_instance described = {
        .logger = pass_on,
        .log = (functions != NULL) ? (void (*)(void))functions->logger : NULL,
        .environment = (functions != NULL) ? functions->componentEnvironment : NULL,
        .logs_events = on != 0,
    };
    if (type != fmi2CoSimulation) {
        pass_on(&described, FMU_ERROR_MESSAGE, "this FMU is for co-simulation, not for model exchange");
        return NULL;
    }
    return fmu_instantiate(&described, name, guid);
}

FMU_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                                          fmi2Boolean has_stop, fmi2Real stop)
{
    fmu_instance *const self = c;
    (void)has_tolerance;
    (void)tolerance;
    (void)has_stop;
    (void)stop;
    if (!fmu_is_allowed(self, INSTANTIATED, "fmi2SetupExperiment")) {
        return fmi2Error;
    }
    self->start = start;
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    fmu_instance *const self = c;
    return status_of(fmu_is_allowed(self, INSTANTIATED, "fmi2EnterInitializationMode") && fmu_initialize(self, self->start));
}

/* ---- Values ---- */

FMU_EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2Real values[])
{
    bool done = fmu_is_allowed(c, READABLE, "fmi2GetReal");
    for (size_t index = 0U; done && (index < count); index++) {
        done = fmu_get_real(c, references[index], &values[index]);
    }
    return status_of(done);
}

FMU_EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                  const fmi2Real values[])
{
    bool done = fmu_is_allowed(c, ANY, "fmi2SetReal");
    for (size_t index = 0U; done && (index < count); index++) {
        done = fmu_set_real(c, references[index], values[index]);
    }
    return status_of(done);
}

FMU_EXPORT fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                     fmi2Integer values[])
{
    bool done = fmu_is_allowed(c, READABLE, "fmi2GetInteger");
    for (size_t index = 0U; done && (index < count); index++) {
        int64_t value = 0;
        done = fmu_get_integer(c, references[index], &value);
        if (done && ((value < INT32_MIN) || (value > INT32_MAX))) {
            return status_of(fmu_fail(c, "an integer has more than the 32 bits of FMI 2.0"));
        }
        values[index] = (fmi2Integer)value;
    }
    return status_of(done);
}

FMU_EXPORT fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                     const fmi2Integer values[])
{
    bool done = fmu_is_allowed(c, ANY, "fmi2SetInteger");
    for (size_t index = 0U; done && (index < count); index++) {
        done = fmu_set_integer(c, references[index], values[index]);
    }
    return status_of(done);
}

FMU_EXPORT fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                     fmi2Boolean values[])
{
    bool done = fmu_is_allowed(c, READABLE, "fmi2GetBoolean");
    for (size_t index = 0U; done && (index < count); index++) {
        bool value = false;
        done = fmu_get_boolean(c, references[index], &value);
        values[index] = value ? 1 : 0;
    }
    return status_of(done);
}

FMU_EXPORT fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                     const fmi2Boolean values[])
{
    bool done = fmu_is_allowed(c, ANY, "fmi2SetBoolean");
    for (size_t index = 0U; done && (index < count); index++) {
        done = fmu_set_boolean(c, references[index], values[index] != 0);
    }
    return status_of(done);
}

FMU_EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2String values[])
{
    (void)references;
    (void)values;
    return (count == 0U) ? fmi2OK : status_of(fmu_fail(c, "this FMU has no strings"));
}

FMU_EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                    const fmi2String values[])
{
    (void)references;
    (void)values;
    return (count == 0U) ? fmi2OK : status_of(fmu_fail(c, "this FMU has no strings"));
}

/* ---- Steps ---- */

FMU_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real length, fmi2Boolean keeps_earlier)
{
    (void)keeps_earlier;
    return status_of(fmu_is_allowed(c, STEPPING, "fmi2DoStep") && fmu_step(c, time, length, false));
}

FMU_EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    return status_of(fmu_fail(c, "no step is pending"));
}

FMU_EXPORT fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind kind, fmi2Status *value)
{
    const fmu_instance *const self = c;
    if (kind != fmi2DoStepStatus) {
        return fmi2Discard;
    }
    *value = (self->phase == FMU_FAILED) ? fmi2Error : fmi2OK;
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real *value)
{
    if (kind != fmi2LastSuccessfulTime) {
        return fmi2Discard;
    }
    *value = fmu_time(c);
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind kind, fmi2Integer *value)
{
    (void)c;
    (void)kind;
    (void)value;
    return fmi2Discard;
}

FMU_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean *value)
{
    (void)c;
    if (kind != fmi2Terminated) {
        return fmi2Discard;
    }
    *value = 0;
    return fmi2OK;
}

FMU_EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind kind, fmi2String *value)
{
    (void)c;
    (void)kind;
    *value = "";
    return fmi2Discard;
}

/* ---- What this FMU does not have ---- */

FMU_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[], size_t unknown_count,
                                                   const fmi2ValueReference knowns[], size_t known_count,
                                                   const fmi2Real seed[], fmi2Real sensitivity[])
{
    (void)unknowns;
    (void)unknown_count;
    (void)knowns;
    (void)known_count;
    (void)seed;
    (void)sensitivity;
    return status_of(fmu_fail(c, "this FMU has no directional derivatives"));
}

FMU_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                                  const fmi2Integer orders[], const fmi2Real values[])
{
    (void)references;
    (void)count;
    (void)orders;
    (void)values;
    return status_of(fmu_fail(c, "this FMU does not interpolate its inputs"));
}

FMU_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference references[], size_t count,
                                                   const fmi2Integer orders[], fmi2Real values[])
{
    (void)references;
    (void)count;
    (void)orders;
    (void)values;
    return status_of(fmu_fail(c, "the outputs of this FMU have no derivatives"));
}
