/* FMI 3.0 for co-simulation (https://fmi-standard.org, version 3.0.2), on fmu.h. */
#include <stdlib.h>
#include <string.h>

#include "fmu.h"

/* ---- The types of the standard ---- */

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef const char *fmi3String;
typedef const uint8_t *fmi3Binary;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef int fmi3Qualifier; /* fmi3IntervalQualifier, fmi3DependencyKind */

typedef void fmi3LogMessageCallback(fmi3InstanceEnvironment, fmi3Status, fmi3String category, fmi3String message);

/* ---- What both versions have ---- */

#define FMI(name) fmi3##name
#define FMI_STATE(before, after) FMI_STATE_(before, after)
#define FMI_STATE_(before, after) fmi3##before##FMUState##after
#define FMI_READ Deserialize
#define FMI_TEXT(name) "fmi3" #name
#define FMI_BOOLEAN bool
#include "fmi_common.h"

static void pass_on(const fmu_instance *self, fmu_severity severity, const char *text)
{
    fmi3LogMessageCallback *const logger = (fmi3LogMessageCallback *)self->log;
    const bool is_error = severity == FMU_ERROR_MESSAGE;
    if (logger != NULL) {
        logger(self->environment, is_error ? fmi3Error : fmi3OK, is_error ? "logStatusError" : "logEvents", text);
    }
}

/* ---- Life ---- */

FMU_EXPORT const char *fmi3GetVersion(void)
{
    return "3.0";
}

FMU_EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, bool visible,
                                                    bool on, bool event_mode, bool early_return,
                                                    const fmi3ValueReference intermediate[], size_t intermediate_count,
                                                    fmi3InstanceEnvironment environment, fmi3LogMessageCallback *log,
                                                    void (*update)(void))
{
    (void)resources;
    (void)visible;
    (void)intermediate;
    (void)intermediate_count;
    (void)update;
    const fmu_instance described = {
        .logger = pass_on,
        .log = (void (*)(void))log,
        .environment = environment,
        .logs_events = on,
        .has_event_mode = event_mode,
        .may_return_early = early_return,
    };
    return fmu_instantiate(&described, name, token);
}

static fmi3Instance refuse_instance(fmi3InstanceEnvironment environment, fmi3LogMessageCallback *log)
{
    if (log != NULL) {
        log(environment, fmi3Error, "logStatusError", "this FMU is for co-simulation only");
    }
    return NULL;
}

FMU_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, bool visible,
                                                     bool on, fmi3InstanceEnvironment environment,
                                                     fmi3LogMessageCallback *log)
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)on;
    return refuse_instance(environment, log);
}

FMU_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                          bool visible, bool on, fmi3InstanceEnvironment environment,
                                                          fmi3LogMessageCallback *log, void (*update)(void),
                                                          void (*lock)(void), void (*unlock)(void))
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)on;
    (void)update;
    (void)lock;
    (void)unlock;
    return refuse_instance(environment, log);
}

FMU_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance c, bool has_tolerance, double tolerance, double start,
                                                  bool has_stop, double stop)
{
    (void)has_tolerance;
    (void)tolerance;
    (void)has_stop;
    (void)stop;
    return status_of(fmu_is_allowed(c, INSTANTIATED, "fmi3EnterInitializationMode") && fmu_initialize(c, start));
}

/* ---- Values ---- */

static bool has_type(fmu_instance *self, fmi3ValueReference reference, fmu_type wanted)
{
    fmu_type type = wanted;
    if (!fmu_type_of(self, reference, &type)) {
        return false;
    }
    type = (type == FMU_TIME) ? FMU_FLOAT64 : (type == FMU_ENUMERATION) ? FMU_INT64 : type;
    return (type == wanted) || fmu_fail(self, "a variable has another type than that of the function");
}

/* Whether there are as many values as references: no variable of this FMU is an array. */
static bool is_scalar(fmu_instance *self, size_t references, size_t values)
{
    return (references == values) || fmu_fail(self, "there are more or fewer values than value references");
}

/* The two functions for variables of one type; `wide` is what fmu.h passes its values as. */
#define ACCESS(name, type, code, kind, wide)                                                                           \
    FMU_EXPORT fmi3Status fmi3Get##name(fmi3Instance c, const fmi3ValueReference references[], size_t count,           \
                                        type values[], size_t value_count)                                             \
    {                                                                                                                  \
        bool done = fmu_is_allowed(c, READABLE, "fmi3Get" #name) && is_scalar(c, count, value_count);                  \
        for (size_t index = 0U; done && (index < count); index++) {                                                    \
            wide value = 0;                                                                                            \
            done = has_type(c, references[index], code) && fmu_get_##kind(c, references[index], &value);               \
            values[index] = (type)value;                                                                               \
        }                                                                                                              \
        return status_of(done);                                                                                        \
    }                                                                                                                  \
    FMU_EXPORT fmi3Status fmi3Set##name(fmi3Instance c, const fmi3ValueReference references[], size_t count,           \
                                        const type values[], size_t value_count)                                       \
    {                                                                                                                  \
        bool done = fmu_is_allowed(c, ANY, "fmi3Set" #name) && is_scalar(c, count, value_count);                       \
        for (size_t index = 0U; done && (index < count); index++) {                                                    \
            done = has_type(c, references[index], code) && fmu_set_##kind(c, references[index], values[index]);        \
        }                                                                                                              \
        return status_of(done);                                                                                        \
    }

ACCESS(Float32, float, FMU_FLOAT32, real, double)
ACCESS(Float64, double, FMU_FLOAT64, real, double)
ACCESS(Int8, int8_t, FMU_INT8, integer, int64_t)
ACCESS(UInt8, uint8_t, FMU_UINT8, integer, int64_t)
ACCESS(Int16, int16_t, FMU_INT16, integer, int64_t)
ACCESS(UInt16, uint16_t, FMU_UINT16, integer, int64_t)
ACCESS(Int32, int32_t, FMU_INT32, integer, int64_t)
ACCESS(UInt32, uint32_t, FMU_UINT32, integer, int64_t)
ACCESS(Int64, int64_t, FMU_INT64, integer, int64_t)
ACCESS(Boolean, bool, FMU_BOOLEAN, boolean, bool)

/* Clocks: an active input clock is an event with the present value; an output clock is active if there was an event. */
FMU_EXPORT fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference references[], size_t count, bool values[])
{
    bool done = fmu_is_allowed(c, IN_EVENT | INITIALIZING, "fmi3GetClock");
    for (size_t index = 0U; done && (index < count); index++) {
        done = has_type(c, references[index], FMU_CLOCK) && fmu_get_boolean(c, references[index], &values[index]);
    }
    return status_of(done);
}

FMU_EXPORT fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference references[], size_t count, const bool values[])
{
    bool done = fmu_is_allowed(c, IN_EVENT | INITIALIZING, "fmi3SetClock");
    for (size_t index = 0U; done && (index < count); index++) {
        done = has_type(c, references[index], FMU_CLOCK) && fmu_set_boolean(c, references[index], values[index]);
    }
    return status_of(done);
}

/* ---- Events and steps ---- */

FMU_EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance c)
{
    fmu_instance *const self = c;
    if (!self->has_event_mode) {
        return status_of(fmu_fail(self, "the instance was made without event mode"));
    }
    if (!fmu_is_allowed(self, STEPPING, "fmi3EnterEventMode")) {
        return fmi3Error;
    }
    self->phase = FMU_IN_EVENT;
    return fmi3OK;
}

FMU_EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance c)
{
    fmu_instance *const self = c;
    if (!fmu_is_allowed(self, IN_EVENT, "fmi3EnterStepMode")) {
        return fmi3Error;
    }
    self->phase = FMU_STEPPING;
    return fmi3OK;
}

FMU_EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c)
{
    (void)c;
    return fmi3OK;
}

/* The instant is done with the inputs as they are. If that writes events, their clocks are active, and a further update makes them inactive. */
FMU_EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, bool *again, bool *terminate, bool *nominals, bool *states,
                                               bool *has_next, double *next)
{
    fmu_instance *const self = c;
    *again = false;
    *terminate = false;
    *nominals = false;
    *states = false;
    *has_next = false;
    *next = 0.0;
    if (!fmu_is_allowed(self, IN_EVENT, "fmi3UpdateDiscreteStates")) {
        return fmi3Error;
    }
    fmu_clear_events(self->model);
    if (!fmu_update(self)) {
        return fmi3Error;
    }
    const int64_t instant = fmu_next(self->model);
    *again = fmu_has_events(self->model);
    *has_next = fmu_takes_samples && (instant != INT64_MAX);
    *next = *has_next ? fmu_time_of(self, instant) : 0.0;
    return fmi3OK;
}

FMU_EXPORT fmi3Status fmi3DoStep(fmi3Instance c, double time, double length, bool keeps_earlier, bool *needs_events,
                                 bool *terminate, bool *early, double *reached)
{
    fmu_instance *const self = c;
    (void)keeps_earlier;
    *needs_events = false;
    *terminate = false;
    *early = false;
    *reached = time;
    if (!fmu_is_allowed(self, STEPPING, "fmi3DoStep") || !fmu_step(self, time, length, self->may_return_early)) {
        return fmi3Error;
    }
    const double end = fmu_time(self);
    *early = self->may_return_early && (end < ((time + length) - 1e-9));
    *reached = *early ? end : (time + length);
    *needs_events = self->has_event_mode && (*early || fmu_has_events(self->model));
    return fmi3OK;
}

FMU_EXPORT fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference reference, size_t *count)
{
    (void)c;
    (void)reference;
    *count = 0U;
    return fmi3OK;
}

FMU_EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *count)
{
    (void)c;
    *count = 0U;
    return fmi3OK;
}

FMU_EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *count)
{
    (void)c;
    *count = 0U;
    return fmi3OK;
}

/* ---- What this FMU does not have ---- */

#define REFUSED(function, parameters)                                                                                  \
    FMU_EXPORT fmi3Status function parameters;                                                                         \
    FMU_EXPORT fmi3Status function parameters                                                                          \
    {                                                                                                                  \
        return status_of(fmu_fail(c, "this FMU does not have " #function));                                            \
    }

#define REFERENCES fmi3Instance c, const fmi3ValueReference references[], size_t count

REFUSED(fmi3GetUInt64, (REFERENCES, uint64_t values[], size_t value_count))
REFUSED(fmi3SetUInt64, (REFERENCES, const uint64_t values[], size_t value_count))
REFUSED(fmi3GetString, (REFERENCES, fmi3String values[], size_t value_count))
REFUSED(fmi3SetString, (REFERENCES, const fmi3String values[], size_t value_count))
REFUSED(fmi3GetBinary, (REFERENCES, size_t sizes[], fmi3Binary values[], size_t value_count))
REFUSED(fmi3SetBinary, (REFERENCES, const size_t sizes[], const fmi3Binary values[], size_t value_count))
REFUSED(fmi3GetVariableDependencies, (fmi3Instance c, fmi3ValueReference reference, size_t elements[],
        fmi3ValueReference independents[], size_t others[], fmi3Qualifier kinds[], size_t count))
REFUSED(fmi3GetDirectionalDerivative, (REFERENCES, const fmi3ValueReference knowns[], size_t known_count, const double
        seed[], size_t seed_count, double sensitivity[], size_t sensitivity_count))
REFUSED(fmi3GetAdjointDerivative, (REFERENCES, const fmi3ValueReference knowns[], size_t known_count, const double
        seed[], size_t seed_count, double sensitivity[], size_t sensitivity_count))
REFUSED(fmi3EnterConfigurationMode, (fmi3Instance c))
REFUSED(fmi3ExitConfigurationMode, (fmi3Instance c))
REFUSED(fmi3GetIntervalDecimal, (REFERENCES, double intervals[], fmi3Qualifier qualifiers[]))
REFUSED(fmi3GetIntervalFraction, (REFERENCES, uint64_t counters[], uint64_t resolutions[], fmi3Qualifier
        qualifiers[]))
REFUSED(fmi3GetShiftDecimal, (REFERENCES, double shifts[]))
REFUSED(fmi3GetShiftFraction, (REFERENCES, uint64_t counters[], uint64_t resolutions[]))
REFUSED(fmi3SetIntervalDecimal, (REFERENCES, const double intervals[]))
REFUSED(fmi3SetIntervalFraction, (REFERENCES, const uint64_t counters[], const uint64_t resolutions[]))
REFUSED(fmi3SetShiftDecimal, (REFERENCES, const double shifts[]))
REFUSED(fmi3SetShiftFraction, (REFERENCES, const uint64_t counters[], const uint64_t resolutions[]))
REFUSED(fmi3EnterContinuousTimeMode, (fmi3Instance c))
REFUSED(fmi3CompletedIntegratorStep, (fmi3Instance c, bool keeps_earlier, bool *enters_event_mode, bool *terminate))
REFUSED(fmi3SetTime, (fmi3Instance c, double time))
REFUSED(fmi3SetContinuousStates, (fmi3Instance c, const double states[], size_t count))
REFUSED(fmi3GetContinuousStateDerivatives, (fmi3Instance c, double derivatives[], size_t count))
REFUSED(fmi3GetEventIndicators, (fmi3Instance c, double indicators[], size_t count))
REFUSED(fmi3GetContinuousStates, (fmi3Instance c, double states[], size_t count))
REFUSED(fmi3GetNominalsOfContinuousStates, (fmi3Instance c, double nominals[], size_t count))
REFUSED(fmi3GetOutputDerivatives, (REFERENCES, const int32_t orders[], double values[], size_t value_count))
REFUSED(fmi3ActivateModelPartition, (fmi3Instance c, fmi3ValueReference clock, double time))
