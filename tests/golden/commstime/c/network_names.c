/* SPDX-License-Identifier: 0BSD */
#include "network.h"

#if CSP_TRACE || CSP_MEASURE || CSP_TRACE_HOOK
const uint32_t network_channel_count = 4U;
const char *const network_channel_names[] = {
    "Commstime.a",
    "Commstime.b",
    "Commstime.c",
    "Commstime.d",
};
const uint32_t network_channel_sizes[] = {
    sizeof(int64_t),
    sizeof(int64_t),
    sizeof(int64_t),
    sizeof(int64_t),
};

/* Numbers of processes and groups count from 1; a group has no kind. */
const uint32_t network_process_count = 5U;
const char *const network_process_names[] = {
    "",
    "Commstime",
    "Commstime.prefix",
    "Commstime.delta",
    "Commstime.successor",
    "Commstime.consumer",
};
const char *const network_process_kinds[] = {
    "",
    "Commstime",
    "Prefix",
    "Delta",
    "Successor",
    "Consumer",
};
#else
typedef int network_has_no_names;
#endif
