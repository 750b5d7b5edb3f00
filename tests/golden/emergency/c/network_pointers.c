/* SPDX-License-Identifier: 0BSD */
/* Where the pointers of struct network are, so that copies can be moved. */
#include "network_pointers.h"

#include "network.h"
#include "spindle.h"
#include "spindle_controller.h"

csp_function *const network_functions[CSP_NETWORK_FUNCTIONS] = {
    (csp_function *)csp_advance, (csp_function *)spindle_initialize,
    (csp_function *)spindle_controller_initialize
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

static const csp_pointer_member pointers_of_csp_ends_members[] =
    {{offsetof(csp_ends, first), 1U, sizeof(void *), NULL}};
static const csp_pointers pointers_of_csp_ends = {pointers_of_csp_ends_members, 1U};

static const csp_pointer_member pointers_of_csp_event_end_members[] = {
    {offsetof(csp_event_end, port), 1U, sizeof(void *), NULL},
    {offsetof(csp_event_end, next), 1U, sizeof(void *), NULL},
    {offsetof(csp_event_end, readers), 1U, sizeof(csp_queue), &pointers_of_csp_queue},
    {offsetof(csp_event_end, inputs), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_event_end = {pointers_of_csp_event_end_members, 4U};

static const csp_pointer_member pointers_of_csp_sampled_end_members[] = {
    {offsetof(csp_sampled_end, port), 1U, sizeof(void *), NULL},
    {offsetof(csp_sampled_end, next), 1U, sizeof(void *), NULL},
    {offsetof(csp_sampled_end, next_of_owner), 1U, sizeof(void *), NULL},
    {offsetof(csp_sampled_end, pace), 1U, sizeof(void *), NULL},
    {offsetof(csp_sampled_end, reader), 1U, sizeof(void *), NULL},
    {offsetof(csp_sampled_end, inputs), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_sampled_end = {pointers_of_csp_sampled_end_members, 6U};

static const csp_pointer_member pointers_of_csp_alternative_members[] = {
    {offsetof(csp_alternative, present_ready), 1U, sizeof(void *), NULL},
    {offsetof(csp_alternative, present_enabled), 1U, sizeof(void *), NULL},
    {offsetof(csp_alternative, present_guard), 1U, sizeof(void *), NULL},
    {offsetof(csp_alternative, more_ready), 1U, sizeof(void *), NULL},
    {offsetof(csp_alternative, more_enabled), 1U, sizeof(void *), NULL},
    {offsetof(csp_alternative, guard), 1U, sizeof(void *), NULL},
    {offsetof(csp_alternative, process), 1U, sizeof(void *), NULL},
    {offsetof(csp_alternative, pledge), 1U, sizeof(csp_party), &pointers_of_csp_party},
    {offsetof(csp_alternative, interrupt), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_alternative = {pointers_of_csp_alternative_members, 9U};

static const csp_pointer_member pointers_of_csp_guard_members[] = {
    {offsetof(csp_guard, next), 1U, sizeof(void *), NULL},
    {offsetof(csp_guard, alternative), 1U, sizeof(void *), NULL},
    {offsetof(csp_guard, word), 1U, sizeof(void *), NULL},
    {offsetof(csp_guard, medium), 1U, sizeof(void *), NULL},
    {offsetof(csp_guard, at.slot), 1U, sizeof(void *), NULL},
    {offsetof(csp_guard, enrolled), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_guard = {pointers_of_csp_guard_members, 6U};

static const csp_pointer_member pointers_of_csp_timer_members[] = {
    {offsetof(csp_timer, child), 1U, sizeof(void *), NULL},
    {offsetof(csp_timer, sibling), 1U, sizeof(void *), NULL},
    {offsetof(csp_timer, previous), 1U, sizeof(void *), NULL},
    {offsetof(csp_timer, party), 1U, sizeof(void *), NULL},
    {offsetof(csp_timer, guard), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_timer = {pointers_of_csp_timer_members, 5U};

static const csp_pointer_member pointers_of_csp_parallel_members[] = {
    {offsetof(csp_parallel, parent), 1U, sizeof(void *), NULL},
    {offsetof(csp_parallel, interrupt), 1U, sizeof(void *), NULL},
    {offsetof(csp_parallel, branches), 1U, sizeof(void *), NULL},
    {offsetof(csp_parallel, error), 1U, sizeof(csp_error), &pointers_of_csp_error}
};
static const csp_pointers pointers_of_csp_parallel = {pointers_of_csp_parallel_members, 4U};

static const csp_pointer_member pointers_of_csp_interrupt_members[] = {
    {offsetof(csp_interrupt, victim), 1U, sizeof(void *), NULL},
    {
        offsetof(csp_interrupt, alternative), 1U, sizeof(csp_alternative),
        &pointers_of_csp_alternative
    },
    {offsetof(csp_interrupt, guard), 1U, sizeof(csp_guard), &pointers_of_csp_guard},
    {offsetof(csp_interrupt, timer), 1U, sizeof(csp_timer), &pointers_of_csp_timer},
    {offsetof(csp_interrupt, canceller), 1U, sizeof(csp_party), &pointers_of_csp_party},
    {offsetof(csp_interrupt, body), 1U, sizeof(csp_parallel), &pointers_of_csp_parallel}
};
static const csp_pointers pointers_of_csp_interrupt = {pointers_of_csp_interrupt_members, 6U};

static const csp_pointer_member pointers_of_spindle_members[] = {
    {offsetof(struct spindle, process), 1U, sizeof(csp_process), &pointers_of_csp_process},
    {offsetof(struct spindle, samples), 1U, sizeof(csp_ends), &pointers_of_csp_ends},
    {offsetof(struct spindle, control), 1U, sizeof(void *), NULL},
    {offsetof(struct spindle, brake), 1U, sizeof(void *), NULL},
    {offsetof(struct spindle, halted), 1U, sizeof(void *), NULL},
    {offsetof(struct spindle, panel), 1U, sizeof(void *), NULL},
    {offsetof(struct spindle, panel_latch), 1U, sizeof(csp_event_end), &pointers_of_csp_event_end},
    {offsetof(struct spindle, feedback), 1U, sizeof(csp_sampled_end), &pointers_of_csp_sampled_end},
    {
        offsetof(struct spindle, repeat_law_branch), 1U, sizeof(csp_process),
        &pointers_of_csp_process
    },
    {
        offsetof(struct spindle, interrupt_repeat_law), 1U, sizeof(csp_interrupt),
        &pointers_of_csp_interrupt
    }
};
static const csp_pointers pointers_of_spindle = {pointers_of_spindle_members, 10U};

static const csp_pointer_member pointers_of_csp_driver_members[] = {
    {offsetof(csp_driver, device), 1U, sizeof(void *), NULL},
    {offsetof(csp_driver, read), 1U, sizeof(void *), NULL},
    {offsetof(csp_driver, write), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_driver = {pointers_of_csp_driver_members, 3U};

static const csp_pointer_member pointers_of_csp_event_input_members[] = {
    {offsetof(csp_event_input, driver), 1U, sizeof(csp_driver), &pointers_of_csp_driver},
    {offsetof(csp_event_input, value), 1U, sizeof(void *), NULL},
    {offsetof(csp_event_input, brought), 1U, sizeof(void *), NULL},
    {offsetof(csp_event_input, ends), 1U, sizeof(void *), NULL},
    {offsetof(csp_event_input, shared), 1U, sizeof(csp_event_end), &pointers_of_csp_event_end}
};
static const csp_pointers pointers_of_csp_event_input = {pointers_of_csp_event_input_members, 5U};

static const csp_pointer_member pointers_of_csp_sampled_input_members[] = {
    {offsetof(csp_sampled_input, driver), 1U, sizeof(csp_driver), &pointers_of_csp_driver},
    {offsetof(csp_sampled_input, value), 1U, sizeof(void *), NULL},
    {offsetof(csp_sampled_input, ends), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_sampled_input =
    {pointers_of_csp_sampled_input_members, 3U};

static const csp_pointer_member pointers_of_csp_latched_output_members[] = {
    {offsetof(csp_latched_output, name), 1U, sizeof(void *), NULL},
    {offsetof(csp_latched_output, driver), 1U, sizeof(csp_driver), &pointers_of_csp_driver},
    {offsetof(csp_latched_output, value), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_latched_output =
    {pointers_of_csp_latched_output_members, 3U};

static const csp_pointer_member pointers_of_csp_direct_output_members[] = {
    {offsetof(csp_direct_output, name), 1U, sizeof(void *), NULL},
    {offsetof(csp_direct_output, driver), 1U, sizeof(csp_driver), &pointers_of_csp_driver}
};
static const csp_pointers pointers_of_csp_direct_output =
    {pointers_of_csp_direct_output_members, 2U};

static const csp_pointer_member network_pointers_members[] = {
    {offsetof(struct network, kernel), 1U, sizeof(csp_kernel), &pointers_of_csp_kernel},
    {offsetof(struct network, top), 1U, sizeof(struct spindle), &pointers_of_spindle},
    {
        offsetof(struct network, external.panel), 1U, sizeof(csp_event_input),
        &pointers_of_csp_event_input
    },
    {
        offsetof(struct network, external.feedback), 1U, sizeof(csp_sampled_input),
        &pointers_of_csp_sampled_input
    },
    {
        offsetof(struct network, external.control), 1U, sizeof(csp_latched_output),
        &pointers_of_csp_latched_output
    },
    {
        offsetof(struct network, external.brake), 1U, sizeof(csp_latched_output),
        &pointers_of_csp_latched_output
    },
    {
        offsetof(struct network, external.halted), 1U, sizeof(csp_direct_output),
        &pointers_of_csp_direct_output
    }
};
const csp_pointers network_pointers = {network_pointers_members, 7U};
