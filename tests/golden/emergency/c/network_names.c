/* SPDX-License-Identifier: 0BSD */
#include "network.h"
#include "types.h"

#if CSP_TRACE || CSP_MEASURE || CSP_TRACE_HOOK
const uint32_t network_channel_count = 5U;
const char *const network_channel_names[] = {
    "Spindle.panel",
    "Spindle.feedback",
    "Spindle.control",
    "Spindle.brake",
    "Spindle.halted",
};
const uint32_t network_channel_sizes[] = {
    sizeof(enum emergency_button),
    sizeof(double),
    sizeof(double),
    sizeof(bool),
    sizeof(bool),
};

/* Numbers of processes and groups count from 1; a group has no kind. */
const uint32_t network_process_count = 1U;
const char *const network_process_names[] = {
    "",
    "Spindle",
};
const char *const network_process_kinds[] = {
    "",
    "Spindle",
};
#else
typedef int network_has_no_names;
#endif
