/* An FMU for co-simulation, FMI 2.0, whose step from 0.05 s returns STATUS. It says why only if messages are asked for. */
#include <stdlib.h>

typedef void logger(void *environment, const char *name, int status, const char *category, const char *message, ...);

typedef struct {
    logger *log;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void *finished;
    void *environment;
} callbacks;

static const callbacks *called;
static int tells;
static double now;

void *fmi2Instantiate(const char *name, int kind, const char *guid, const char *resources, const callbacks *functions,
                      int visible, int logging)
{
    called = functions;
    tells = logging;
    now = 0.0;
    return malloc(1);
}
void fmi2FreeInstance(void *c) { free(c); }
int fmi2SetupExperiment(void *c, int has_tolerance, double tolerance, double start, int has_stop, double stop) { return 0; }
int fmi2EnterInitializationMode(void *c) { return 0; }
int fmi2ExitInitializationMode(void *c) { return 0; }
int fmi2DoStep(void *c, double time, double step, int no_set)
{
    now = time + step;
    if (tells && now > 0.035) {
        called->log(called->environment, "one", 0, "logAll", "stepping");
    }
    if (now < 0.055) {
        return 0;
    }
    if (tells) {
        called->log(called->environment, "one", STATUS, "logStatusError", "the tank is %s", "empty");
        called->log(called->environment, "one", 0, "logAll", "done");
    }
    return STATUS;
}
int fmi2GetReal(void *c, const unsigned *references, size_t count, double *values)
{
    values[0] = now;
    return 0;
}
int fmi2SetReal(void *c, const unsigned *references, size_t count, const double *values) { return 0; }

/* fmpy wants these to be there, and nobody calls them. */
#define UNUSED(name)                                                                                                           \
    int fmi2##name(void) { return 3; }
UNUSED(GetTypesPlatform) UNUSED(GetVersion) UNUSED(SetDebugLogging) UNUSED(Terminate) UNUSED(Reset)
UNUSED(GetInteger) UNUSED(SetInteger) UNUSED(GetBoolean) UNUSED(SetBoolean) UNUSED(GetString) UNUSED(SetString)
UNUSED(GetFMUstate) UNUSED(SetFMUstate) UNUSED(FreeFMUstate)
UNUSED(SerializedFMUstateSize) UNUSED(SerializeFMUstate) UNUSED(DeSerializeFMUstate) UNUSED(GetDirectionalDerivative)
UNUSED(SetRealInputDerivatives) UNUSED(GetRealOutputDerivatives) UNUSED(CancelStep)
UNUSED(GetStatus) UNUSED(GetRealStatus) UNUSED(GetIntegerStatus) UNUSED(GetBooleanStatus) UNUSED(GetStringStatus)
