/* SPDX-License-Identifier: 0BSD */
/* Where the pointers of struct network are, so that copies can be moved. */
#include "network_pointers.h"

#include "network.h"
#include "commstime.h"
#include "consumer.h"
#include "delta.h"
#include "prefix.h"
#include "successor.h"

csp_function *const network_functions[CSP_NETWORK_FUNCTIONS] = {
    (csp_function *)csp_advance, (csp_function *)commstime_initialize,
    (csp_function *)consumer_initialize, (csp_function *)delta_initialize,
    (csp_function *)prefix_initialize, (csp_function *)successor_initialize
};

static const csp_pointer_member pointers_of_csp_queue_members[] = {
    {offsetof(csp_queue, first), 1U, sizeof(void *), NULL},
    {offsetof(csp_queue, last), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_queue = {pointers_of_csp_queue_members, 2U};

static const csp_pointer_member pointers_of_csp_operands_members[] =
    {{offsetof(csp_operands, name), 1U, sizeof(void *), NULL}};
static const csp_pointers pointers_of_csp_operands = {pointers_of_csp_operands_members, 1U};

static const csp_pointer_member pointers_of_csp_fault_note_members[] = {
    {offsetof(csp_fault_note, describe), 1U, sizeof(void *), NULL},
    {offsetof(csp_fault_note, operands), 1U, sizeof(csp_operands), &pointers_of_csp_operands},
    {offsetof(csp_fault_note, place), 1U, sizeof(void *), NULL},
    {offsetof(csp_fault_note, law), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_fault_note = {pointers_of_csp_fault_note_members, 4U};

static const csp_pointer_member pointers_of_csp_error_members[] = {
    {offsetof(csp_error, process), 1U, sizeof(void *), NULL},
    {offsetof(csp_error, place), 1U, sizeof(void *), NULL},
    {offsetof(csp_error, inner), 1U, sizeof(void *), NULL},
    {offsetof(csp_error, law), 1U, sizeof(void *), NULL},
    {offsetof(csp_error, describe), 1U, sizeof(void *), NULL},
    {offsetof(csp_error, operands), 1U, sizeof(csp_operands), &pointers_of_csp_operands}
};
static const csp_pointers pointers_of_csp_error = {pointers_of_csp_error_members, 6U};

static const csp_pointer_member pointers_of_csp_kernel_members[] = {
    {offsetof(csp_kernel, current), 1U, sizeof(void *), NULL},
    {offsetof(csp_kernel, program), 1U, sizeof(void *), NULL},
    {offsetof(csp_kernel, earliest), 1U, sizeof(void *), NULL},
    {
        offsetof(csp_kernel, ready), CSP_ELEMENTS(csp_kernel, ready, ready[0]), sizeof(csp_queue),
        &pointers_of_csp_queue
    },
    {offsetof(csp_kernel, fault), 1U, sizeof(csp_fault_note), &pointers_of_csp_fault_note},
    {offsetof(csp_kernel, error), 1U, sizeof(csp_error), &pointers_of_csp_error},
    {offsetof(csp_kernel, loop), 1U, sizeof(void *), NULL},
    {offsetof(csp_kernel, called), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_kernel = {pointers_of_csp_kernel_members, 8U};

static const csp_pointer_member pointers_of_csp_party_members[] = {
    {offsetof(csp_party, next), 1U, sizeof(void *), NULL},
    {offsetof(csp_party, step), 1U, sizeof(void *), NULL},
    {offsetof(csp_party, slot), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_party = {pointers_of_csp_party_members, 3U};

static const csp_pointer_member pointers_of_csp_process_members[] = {
    {offsetof(csp_process, party), 1U, sizeof(csp_party), &pointers_of_csp_party},
    {offsetof(csp_process, above), 1U, sizeof(void *), NULL},
    {offsetof(csp_process, kind), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_process = {pointers_of_csp_process_members, 3U};

static const csp_pointer_member pointers_of_csp_channel_members[] =
    {{offsetof(csp_channel, waiting), 1U, sizeof(void *), NULL}};
static const csp_pointers pointers_of_csp_channel = {pointers_of_csp_channel_members, 1U};

static const csp_pointer_member pointers_of_prefix_members[] = {
    {offsetof(struct prefix, process), 1U, sizeof(csp_process), &pointers_of_csp_process},
    {offsetof(struct prefix, input), 1U, sizeof(void *), NULL},
    {offsetof(struct prefix, output), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_prefix = {pointers_of_prefix_members, 3U};

static const csp_pointer_member pointers_of_delta_members[] = {
    {offsetof(struct delta, process), 1U, sizeof(csp_process), &pointers_of_csp_process},
    {offsetof(struct delta, input), 1U, sizeof(void *), NULL},
    {offsetof(struct delta, first), 1U, sizeof(void *), NULL},
    {offsetof(struct delta, second), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_delta = {pointers_of_delta_members, 4U};

static const csp_pointer_member pointers_of_successor_members[] = {
    {offsetof(struct successor, process), 1U, sizeof(csp_process), &pointers_of_csp_process},
    {offsetof(struct successor, input), 1U, sizeof(void *), NULL},
    {offsetof(struct successor, output), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_successor = {pointers_of_successor_members, 3U};

static const csp_pointer_member pointers_of_consumer_members[] = {
    {offsetof(struct consumer, process), 1U, sizeof(csp_process), &pointers_of_csp_process},
    {offsetof(struct consumer, input), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_consumer = {pointers_of_consumer_members, 2U};

static const csp_pointer_member pointers_of_csp_parallel_members[] = {
    {offsetof(csp_parallel, parent), 1U, sizeof(void *), NULL},
    {offsetof(csp_parallel, interrupt), 1U, sizeof(void *), NULL},
    {offsetof(csp_parallel, branches), 1U, sizeof(void *), NULL},
    {offsetof(csp_parallel, error), 1U, sizeof(csp_error), &pointers_of_csp_error}
};
static const csp_pointers pointers_of_csp_parallel = {pointers_of_csp_parallel_members, 4U};

static const csp_pointer_member pointers_of_commstime_members[] = {
    {offsetof(struct commstime, process), 1U, sizeof(csp_process), &pointers_of_csp_process},
    {offsetof(struct commstime, a), 1U, sizeof(csp_channel), &pointers_of_csp_channel},
    {offsetof(struct commstime, b), 1U, sizeof(csp_channel), &pointers_of_csp_channel},
    {offsetof(struct commstime, c), 1U, sizeof(csp_channel), &pointers_of_csp_channel},
    {offsetof(struct commstime, d), 1U, sizeof(csp_channel), &pointers_of_csp_channel},
    {offsetof(struct commstime, prefix), 1U, sizeof(struct prefix), &pointers_of_prefix},
    {offsetof(struct commstime, delta), 1U, sizeof(struct delta), &pointers_of_delta},
    {offsetof(struct commstime, successor), 1U, sizeof(struct successor), &pointers_of_successor},
    {offsetof(struct commstime, consumer), 1U, sizeof(struct consumer), &pointers_of_consumer},
    {offsetof(struct commstime, parallel), 1U, sizeof(csp_parallel), &pointers_of_csp_parallel}
};
static const csp_pointers pointers_of_commstime = {pointers_of_commstime_members, 10U};

static const csp_pointer_member network_pointers_members[] = {
    {offsetof(struct network, kernel), 1U, sizeof(csp_kernel), &pointers_of_csp_kernel},
    {offsetof(struct network, top), 1U, sizeof(struct commstime), &pointers_of_commstime}
};
const csp_pointers network_pointers = {network_pointers_members, 2U};
