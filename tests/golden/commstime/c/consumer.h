/* SPDX-License-Identifier: 0BSD */
/* Takes `rounds` values and ends the network.
 *
 * Source: commstime.csp:47
 */
#ifndef CONSUMER_H
#define CONSUMER_H

#include "csp.h"

/* What the ports are connected to. */
struct consumer_ports {
    csp_channel *input;
};

struct consumer {
    csp_process process;
    int64_t rounds;
    csp_channel *input;
    int64_t value;
};

/* Before the program starts. */
void consumer_initialize(struct consumer *self, csp_numbers *numbers,
    const struct consumer_ports *ports, int64_t rounds);

#endif
