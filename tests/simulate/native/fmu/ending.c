/* An FMU for co-simulation, FMI 2.0, whose step from 0.05 s does HOW. */
#include <stdlib.h>

static double now;

void *fmi2Instantiate(void) { return malloc(1); }
void fmi2FreeInstance(void *c) { free(c); }
int fmi2SetupExperiment(void) { return 0; }
int fmi2EnterInitializationMode(void) { return 0; }
int fmi2ExitInitializationMode(void) { return 0; }
int fmi2DoStep(void *c, double time, double step, int no_set)
{
    now = time + step;
    if (now > 0.055) {
        HOW;
    }
    return 0;
}
int fmi2GetReal(void *c, const unsigned *references, size_t count, double *values)
{
    values[0] = now;
    return 0;
}
int fmi2SetReal(void) { return 0; }

/* fmpy wants these to be there, and nobody calls them. */
#define UNUSED(name)                                                                                                           \
    int fmi2##name(void) { return 3; }
UNUSED(GetTypesPlatform) UNUSED(GetVersion) UNUSED(SetDebugLogging) UNUSED(Terminate) UNUSED(Reset)
UNUSED(GetInteger) UNUSED(SetInteger) UNUSED(GetBoolean) UNUSED(SetBoolean) UNUSED(GetString) UNUSED(SetString)
UNUSED(GetFMUstate) UNUSED(SetFMUstate) UNUSED(FreeFMUstate)
UNUSED(SerializedFMUstateSize) UNUSED(SerializeFMUstate) UNUSED(DeSerializeFMUstate) UNUSED(GetDirectionalDerivative)
UNUSED(SetRealInputDerivatives) UNUSED(GetRealOutputDerivatives) UNUSED(CancelStep)
UNUSED(GetStatus) UNUSED(GetRealStatus) UNUSED(GetIntegerStatus) UNUSED(GetBooleanStatus) UNUSED(GetStringStatus)
