/* SPDX-License-Identifier: 0BSD */
/* The network of Commstime: its processes, its channels, and what is behind its ports. */
#ifndef NETWORK_H
#define NETWORK_H

#include "csp.h"
#include "commstime.h"

/* All memory of the program. */
struct network {
    csp_kernel kernel;
    struct commstime top; /* the outermost process, with all others inside */
};

/* A device or a simulated one for every port. */
struct network_drivers {
    char unused;
};

/* Builds the network, before each run; csp_build says what the hooks are. */
void network_initialize(struct network *self, const struct network_drivers *drivers,
    const csp_hooks *hooks);

extern const csp_program network_program;

#if CSP_TRACE || CSP_MEASURE || CSP_TRACE_HOOK
/* By number: channels and ports, and the sizes of their values; processes and groups. */
extern const uint32_t network_channel_count;
extern const char *const network_channel_names[];
extern const uint32_t network_channel_sizes[];
extern const uint32_t network_process_count;
extern const char *const network_process_names[];
extern const char *const network_process_kinds[];
#endif

#endif
