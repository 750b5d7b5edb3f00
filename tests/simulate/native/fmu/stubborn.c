/* An FMU for model exchange, FMI 2.0, without states. From 0.02 s on it updates its discrete states without end, or, with STUBBORN_ENDS, wants to end. */
#include <stddef.h>
#include <stdlib.h>

typedef struct {
    int again, terminates, nominals, states, has_next;
    double next;
} event_info;

static double now;

void *fmi2Instantiate(const char *name, int kind, const char *guid, const char *resources, const void *functions, int visible,
                      int logging)
{
    now = 0.0;
    return malloc(1);
}
void fmi2FreeInstance(void *c) { free(c); }
int fmi2SetupExperiment(void *c, int has_tolerance, double tolerance, double start, int has_stop, double stop) { return 0; }
int fmi2EnterInitializationMode(void *c) { return 0; }
int fmi2ExitInitializationMode(void *c) { return 0; }
int fmi2EnterEventMode(void *c) { return 0; }
int fmi2EnterContinuousTimeMode(void *c) { return 0; }
int fmi2NewDiscreteStates(void *c, event_info *info)
{
    info->again = now > 0.015;
    info->terminates = info->nominals = info->states = 0;
    info->has_next = 1;
    info->next = now + 0.01;
    return 0;
}
int fmi2CompletedIntegratorStep(void *c, int final, int *enters, int *terminates)
{
    *enters = 0;
#ifdef STUBBORN_ENDS
    *terminates = now > 0.015;
#else
    *terminates = 0;
#endif
    return 0;
}
int fmi2SetTime(void *c, double time)
{
    now = time;
    return 0;
}
int fmi2SetContinuousStates(void *c, const double *x, size_t count) { return 0; }
int fmi2GetReal(void *c, const unsigned *references, size_t count, double *values)
{
    values[0] = now;
    return 0;
}

/* fmpy wants these to be there, and nobody calls them. */
#define UNUSED(name)                                                                                                           \
    int fmi2##name(void) { return 3; }
UNUSED(GetTypesPlatform) UNUSED(GetVersion) UNUSED(SetDebugLogging) UNUSED(Terminate) UNUSED(Reset)
UNUSED(SetReal) UNUSED(GetInteger) UNUSED(SetInteger) UNUSED(GetBoolean) UNUSED(SetBoolean) UNUSED(GetString) UNUSED(SetString)
UNUSED(GetFMUstate) UNUSED(SetFMUstate) UNUSED(FreeFMUstate)
UNUSED(SerializedFMUstateSize) UNUSED(SerializeFMUstate) UNUSED(DeSerializeFMUstate)
UNUSED(GetContinuousStates) UNUSED(GetDerivatives) UNUSED(GetNominalsOfContinuousStates)
UNUSED(GetEventIndicators) UNUSED(GetDirectionalDerivative)
