/* The network of Jiwy: its processes, its channels, and what is behind its ports. */
#ifndef NETWORK_H
#define NETWORK_H

#include "csp.h"
#include "types.h"

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

/* Builds the network, before each run. */
void network_initialize(const struct network_drivers *drivers);

/* An interrupt handler brings an event: the latest value counts. */
void network_bring_joystick_buttons(int64_t value);

extern const csp_program network_program;

#if CSP_TRACE
/* By number: channels and ports, and the sizes of their values; processes and groups. */
extern const uint32_t network_channel_count;
extern const char *const network_channel_names[];
extern const uint32_t network_channel_sizes[];
extern const uint32_t network_process_count;
extern const char *const network_process_names[];
extern const char *const network_process_kinds[];
#endif

#endif
