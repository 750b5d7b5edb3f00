/* SPDX-License-Identifier: 0BSD */
/* The network of Spindle: its processes, its channels, and what is behind its ports. */
#ifndef NETWORK_H
#define NETWORK_H

#include "csp.h"
#include "spindle.h"
#include "types.h"

/* All memory of the program. */
struct network {
    csp_kernel kernel;
    struct spindle top; /* the outermost process, with all others inside */
    struct {
        csp_event_input panel;
        csp_sampled_input feedback;
        csp_latched_output control;
        csp_latched_output brake;
        csp_direct_output halted;
    } external;
    struct {
        enum emergency_button panel;
        double feedback;
        double control;
        bool brake;
    } present;
    struct {
        enum emergency_button panel;
    } brought; /* by interrupt handlers */
};

/* A device or a simulated one for every port. */
struct network_drivers {
    /* reads enum emergency_button */
    csp_driver panel;
    /* reads double */
    csp_driver feedback;
    /* writes double */
    csp_driver control;
    /* writes bool */
    csp_driver brake;
    /* writes bool */
    csp_driver halted;
};

/* Builds the network, before each run; csp_build says what the hooks are. */
void network_initialize(struct network *self, const struct network_drivers *drivers,
    const csp_hooks *hooks);

/* An interrupt handler brings an event; the latest counts. True: one before it is unread. */
bool network_bring_panel(struct network *self, enum emergency_button value);

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
