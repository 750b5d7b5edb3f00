/* SPDX-License-Identifier: 0BSD */
/* The network of Jiwy: its processes, its channels, and what is behind its ports. */
#ifndef NETWORK_H
#define NETWORK_H

#include "csp.h"
#include "jiwy.h"
#include "types.h"

/* All memory of the program. */
struct network {
    csp_kernel kernel;
    struct jiwy_parameters parameters;
    csp_refusal refusal; /* of those that were given last */
    struct jiwy top; /* the outermost process, with all others inside */
    struct {
        csp_sampled_input joystick_horizontal;
        csp_sampled_input joystick_vertical;
        csp_event_input joystick_buttons;
        csp_sampled_input feedback_horizontal;
        csp_sampled_input feedback_vertical;
        csp_latched_output control_horizontal;
        csp_latched_output control_vertical;
    } external;
    struct {
        double joystick_horizontal;
        double joystick_vertical;
        int64_t joystick_buttons;
        double feedback_horizontal;
        double feedback_vertical;
        double control_horizontal;
        double control_vertical;
    } present;
    struct {
        int64_t joystick_buttons;
    } brought; /* by interrupt handlers */
};

/* A device or a simulated one for every port. */
struct network_drivers {
    /* reads double */
    csp_driver joystick_horizontal;
    /* reads double */
    csp_driver joystick_vertical;
    /* reads int64_t */
    csp_driver joystick_buttons;
    /* reads double */
    csp_driver feedback_horizontal;
    /* reads double */
    csp_driver feedback_vertical;
    /* writes double */
    csp_driver control_horizontal;
    /* writes double */
    csp_driver control_vertical;
};

/* Builds the network, before each run; csp_build says what the hooks are. */
void network_initialize(struct network *self, const struct network_drivers *drivers,
    const csp_hooks *hooks, const struct jiwy_parameters *parameters);

/* Sets the parameters, between two steps; false: nothing was done, and `refusal` says why. */
bool network_change_parameters(struct network *self, const struct jiwy_parameters *parameters);

/* The values of the text. */
extern const struct jiwy_parameters network_default_parameters;

/* An interrupt handler brings an event; the latest counts. True: one before it is unread. */
bool network_bring_joystick_buttons(struct network *self, int64_t value);

extern const csp_program network_program;

/* By number: variables that may be read before they were written. */
extern const char *const network_variable_names[];

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
