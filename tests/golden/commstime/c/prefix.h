/* SPDX-License-Identifier: 0BSD */
/* Sends a first value and copies everything that follows.
 *
 * Source: commstime.csp:5
 */
#ifndef PREFIX_H
#define PREFIX_H

#include "csp.h"

/* What the ports are connected to. */
struct prefix_ports {
    csp_channel *input;
    csp_channel *output;
};

struct prefix {
    csp_process process;
    csp_channel *input;
    csp_channel *output;
    int64_t value;
};

/* Before the program starts. */
void prefix_initialize(struct prefix *self, csp_numbers *numbers, const struct prefix_ports *ports,
    int64_t first);

#endif
