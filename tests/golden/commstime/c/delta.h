/* SPDX-License-Identifier: 0BSD */
/* Copies each value to both outputs, one after the other.
 *
 * Source: commstime.csp:19
 */
#ifndef DELTA_H
#define DELTA_H

#include "csp.h"

/* What the ports are connected to. */
struct delta_ports {
    csp_channel *input;
    csp_channel *first;
    csp_channel *second;
};

struct delta {
    csp_process process;
    csp_channel *input;
    csp_channel *first;
    csp_channel *second;
    int64_t value;
};

/* Before the program starts. */
void delta_initialize(struct delta *self, csp_numbers *numbers, const struct delta_ports *ports);

#endif
