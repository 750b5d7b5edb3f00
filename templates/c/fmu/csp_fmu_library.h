/* The loaded binary of an FMU, for the files of csp_fmu.h. */
#ifndef CSP_FMU_LIBRARY_H
#define CSP_FMU_LIBRARY_H

#include "csp_fmu.h"

enum { CSP_FMU_TEXT = 1024, CSP_FMU_KNOWN = 24 };

/* Values of fmi2Status and fmi3Status. */
enum { CSP_FMU_OK = 0, CSP_FMU_DISCARD = 2, CSP_FMU_ERROR = 3 };

/* fmi2CallbackFunctions */
typedef struct csp_fmu_callbacks {
    void (*logger)(void *environment, const char *name, int status, const char *category, const char *message, ...);
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
    void (*finished)(void *environment, int status);
    void *environment;
} csp_fmu_callbacks;

typedef union csp_fmu_value {
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
} csp_fmu_value;

struct csp_fmu_library {
    void *handle;
    void *component;
    csp_fmu_callbacks functions;
    char message[CSP_FMU_TEXT]; /* the last of the FMU */
    char failure[2 * CSP_FMU_TEXT + 200];
    void **getters; /* of outputs */
    void **setters; /* of inputs */
    csp_fmu_value *given; /* the inputs that were set last, as the members of their ports */
    double *x, *moved, *k[4];
    bool *before, *after;
    double *indicators;
    struct {
        const char *name;
        void *function;
    } known[CSP_FMU_KNOWN]; /* functions that have been looked for */
};

/* Loads the binary and makes an instance. False: the failure is noted. */
bool csp_fmu_load(csp_fmu *self);
/* Frees the instance and all memory; the binary stays loaded, as long as the process runs. */
void csp_fmu_unload(struct csp_fmu_library *library, bool is_new);

/* Notes the first failure, after the name of the FMU and before its last message; returns false. */
bool csp_fmu_fail(csp_fmu *self, const char *format, ...);
/* Notes that the FMU wants no further steps; returns false. */
bool csp_fmu_has_ended(csp_fmu *self, double time);
/* `status` is what the function of this name has returned at `time`. */
bool csp_fmu_is_fine(csp_fmu *self, int status, const char *function, double time);
/* A function of the FMU by its name without "fmi2" or "fmi3": a literal, the same in each call. NULL: there is none. */
void *csp_fmu_function(csp_fmu *self, const char *name);
/* One that is not remembered, of two parts: an action and what it is done with. */
void *csp_fmu_find(const csp_fmu *self, const char *action, const char *name);
/* Calls a function that has only the instance as an argument. */
bool csp_fmu_call(csp_fmu *self, const char *function, double time);

/* Values: sets variables from the members of `ports`, and members from outputs. */
bool csp_fmu_set(csp_fmu *self, void *function, const csp_fmu_port *port, const void *ports, double time);
bool csp_fmu_set_all(csp_fmu *self, const csp_fmu_port *table, size_t count, const void *ports, double time);
bool csp_fmu_get_outputs(csp_fmu *self, void *ports, double time);
size_t csp_fmu_size_of(csp_fmu_type type);

/* Model exchange: handles the event at `time`, in event mode, and leaves that mode; integrates up to `end`. */
bool csp_fmu_handle_event(csp_fmu *self, double time);
bool csp_fmu_integrate(csp_fmu *self, double end);

#endif
