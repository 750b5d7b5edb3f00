/* SPDX-License-Identifier: 0BSD */
/* Adds one.
 *
 * Source: commstime.csp:33
 */
#ifndef SUCCESSOR_H
#define SUCCESSOR_H

#include "csp.h"

/* What the ports are connected to. */
struct successor_ports {
    csp_channel *input;
    csp_channel *output;
};

struct successor {
    csp_process process;
    csp_channel *input;
    csp_channel *output;
    int64_t value;
    union {
        int64_t output;
    } sent;
};

/* Before the program starts. */
void successor_initialize(struct successor *self, csp_numbers *numbers,
    const struct successor_ports *ports);

#endif
