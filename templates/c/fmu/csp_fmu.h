/* An FMU of another tool as a part of an environment: loads its binary, and steps it as cspdiag does it in Python, in the same order of operations. */
#ifndef CSP_FMU_H
#define CSP_FMU_H

#include <stddef.h>
#include <stdint.h>

#include "csp_program.h"

/* How a value is stored. */
typedef enum csp_fmu_type {
    CSP_FMU_FLOAT64,
    CSP_FMU_FLOAT32,
    CSP_FMU_INT8,
    CSP_FMU_UINT8,
    CSP_FMU_INT16,
    CSP_FMU_UINT16,
    CSP_FMU_INT32,
    CSP_FMU_UINT32,
    CSP_FMU_INT64,
    CSP_FMU_BOOL,
    CSP_FMU_BOOLEAN /* an int: fmi2Boolean */
} csp_fmu_type;

/* A variable: the end of the names of its functions ("Real"), and its member in the struct of the submodel. */
typedef struct csp_fmu_port {
    uint32_t reference;
    const char *functions;
    csp_fmu_type type;   /* in the FMU */
    csp_fmu_type member; /* in the struct */
    size_t offset;
    bool is_discrete;
    bool lacks_zero; /* of an enumeration without the number 0, which inputs have before they are written */
} csp_fmu_port;

typedef struct csp_fmu_facts {
    const char *name;      /* for messages: the file */
    const char *library;   /* the path of the binary */
    const char *resources; /* an URI for FMI 2.0, a path for FMI 3.0 */
    const char *instance;
    const char *token;
    bool is_new;           /* FMI 3.0, otherwise 2.0 */
    bool is_model_exchange;
    uint32_t states;
    uint32_t indicators;
    int64_t step; /* the longest of the integration, in nanoseconds; 0: that of the environment */
    bool is_euler;
    const csp_fmu_port *parameters;
    size_t parameter_count;
    const csp_fmu_port *inputs;
    size_t input_count;
    const csp_fmu_port *outputs;
    size_t output_count;
} csp_fmu_facts;

/* An instance; zero before it is initialized for the first time. */
typedef struct csp_fmu {
    const csp_fmu_facts *facts;
    struct csp_fmu_library *library;
    bool is_begun;
    double time;
    double next_event; /* infinite: none */
} csp_fmu;

/* Makes a new instance; whatever fails is noted at the first calculation. */
void csp_fmu_initialize(csp_fmu *self, const csp_fmu_facts *facts);

/* The outputs at `time`, in seconds; `ports` is the struct with the members. A failure is noted as a fault. */
void csp_fmu_calculate(csp_kernel *csp, csp_fmu *self, void *ports, double time);

#endif
