/* SPDX-License-Identifier: 0BSD */
/* Changes of parameters that a simulation is given: a file of records, or a pipe to which they are written while it runs. */
#ifndef CSP_TUNING_H
#define CSP_TUNING_H

#include "csp_program.h"

/* The beginning of a record, which is followed by `size` bytes of the new value. */
typedef struct csp_change {
    int64_t time;    /* the change is made at the first instant at or after this one */
    uint32_t number; /* of the change, for reports */
    uint32_t offset; /* of the value in the structure with the parameters */
    uint32_t size;
    uint32_t unused;
} csp_change;

/* Opens the file or pipe; false: it cannot be opened. */
bool csp_tuning_open(const char *path);

/* What csp_run asks; NULL: nothing was opened. */
const csp_tuning *csp_tuning_opened(void);

#endif
