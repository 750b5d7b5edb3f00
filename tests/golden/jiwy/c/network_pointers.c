/* SPDX-License-Identifier: 0BSD */
/* Where the pointers of struct network are, so that copies can be moved. */
#include "network_pointers.h"

#include "network.h"
#include "align.h"
#include "homing.h"
#include "jiwy.h"
#include "joint_control.h"
#include "motion_control.h"
#include "position_controller.h"
#include "velocity_controller.h"

csp_function *const network_functions[CSP_NETWORK_FUNCTIONS] = {
    (csp_function *)csp_advance, (csp_function *)align_initialize,
    (csp_function *)homing_initialize, (csp_function *)jiwy_initialize,
    (csp_function *)joint_control_initialize, (csp_function *)motion_control_initialize,
    (csp_function *)position_controller_initialize, (csp_function *)velocity_controller_initialize
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

static const csp_pointer_member pointers_of_align_members[] = {
    {offsetof(struct align, process), 1U, sizeof(csp_process), &pointers_of_csp_process},
    {offsetof(struct align, samples), 1U, sizeof(csp_ends), &pointers_of_csp_ends},
    {offsetof(struct align, control), 1U, sizeof(void *), NULL},
    {offsetof(struct align, max), 1U, sizeof(void *), NULL},
    {offsetof(struct align, max_written), 1U, sizeof(void *), NULL},
    {offsetof(struct align, feedback), 1U, sizeof(csp_sampled_end), &pointers_of_csp_sampled_end},
    {
        offsetof(struct align, repeat_velocity_branch), 1U, sizeof(csp_process),
        &pointers_of_csp_process
    },
    {
        offsetof(struct align, interrupt_repeat_velocity), 1U, sizeof(csp_interrupt),
        &pointers_of_csp_interrupt
    }
};
static const csp_pointers pointers_of_align = {pointers_of_align_members, 8U};

static const csp_pointer_member pointers_of_csp_event_end_members[] = {
    {offsetof(csp_event_end, port), 1U, sizeof(void *), NULL},
    {offsetof(csp_event_end, next), 1U, sizeof(void *), NULL},
    {offsetof(csp_event_end, readers), 1U, sizeof(csp_queue), &pointers_of_csp_queue},
    {offsetof(csp_event_end, inputs), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_event_end = {pointers_of_csp_event_end_members, 4U};

static const csp_pointer_member pointers_of_position_controller_members[] =
    {{offsetof(struct position_controller, gains), 1U, sizeof(void *), NULL}};
static const csp_pointers pointers_of_position_controller =
    {pointers_of_position_controller_members, 1U};

static const csp_pointer_member pointers_of_csp_offers_members[] = {
    {offsetof(csp_offers, process), 1U, sizeof(void *), NULL},
    {offsetof(csp_offers, offer), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_offers = {pointers_of_csp_offers_members, 2U};

static const csp_pointer_member pointers_of_csp_offer_members[] = {
    {offsetof(csp_offer, party), 1U, sizeof(csp_party), &pointers_of_csp_party},
    {offsetof(csp_offer, offers), 1U, sizeof(void *), NULL},
    {offsetof(csp_offer, medium), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_offer = {pointers_of_csp_offer_members, 3U};

static const csp_pointer_member pointers_of_motion_control_members[] = {
    {offsetof(struct motion_control, process), 1U, sizeof(csp_process), &pointers_of_csp_process},
    {offsetof(struct motion_control, samples), 1U, sizeof(csp_ends), &pointers_of_csp_ends},
    {offsetof(struct motion_control, leftmax), 1U, sizeof(void *), NULL},
    {offsetof(struct motion_control, leftmax_written), 1U, sizeof(void *), NULL},
    {offsetof(struct motion_control, rightmax), 1U, sizeof(void *), NULL},
    {offsetof(struct motion_control, rightmax_written), 1U, sizeof(void *), NULL},
    {offsetof(struct motion_control, control), 1U, sizeof(void *), NULL},
    {offsetof(struct motion_control, joystick_buttons), 1U, sizeof(void *), NULL},
    {
        offsetof(struct motion_control, joystick_buttons_latch), 1U, sizeof(csp_event_end),
        &pointers_of_csp_event_end
    },
    {
        offsetof(struct motion_control, feedback), 1U, sizeof(csp_sampled_end),
        &pointers_of_csp_sampled_end
    },
    {
        offsetof(struct motion_control, joystick_axis), 1U, sizeof(csp_sampled_end),
        &pointers_of_csp_sampled_end
    },
    {
        offsetof(struct motion_control, servo), 1U, sizeof(struct position_controller),
        &pointers_of_position_controller
    },
    {
        offsetof(struct motion_control, choice.alternative), 1U, sizeof(csp_alternative),
        &pointers_of_csp_alternative
    },
    {
        offsetof(struct motion_control, choice.guards),
        CSP_ELEMENTS(struct motion_control, choice.guards, choice.guards[0]), sizeof(csp_guard),
        &pointers_of_csp_guard
    },
    {offsetof(struct motion_control, offers), 1U, sizeof(csp_offers), &pointers_of_csp_offers},
    {
        offsetof(struct motion_control, offers_made),
        CSP_ELEMENTS(struct motion_control, offers_made, offers_made[0]), sizeof(csp_offer),
        &pointers_of_csp_offer
    }
};
static const csp_pointers pointers_of_motion_control = {pointers_of_motion_control_members, 16U};

static const csp_pointer_member pointers_of_homing_members[] = {
    {offsetof(struct homing, process), 1U, sizeof(csp_process), &pointers_of_csp_process},
    {offsetof(struct homing, samples), 1U, sizeof(csp_ends), &pointers_of_csp_ends},
    {offsetof(struct homing, leftmax), 1U, sizeof(void *), NULL},
    {offsetof(struct homing, leftmax_written), 1U, sizeof(void *), NULL},
    {offsetof(struct homing, rightmax), 1U, sizeof(void *), NULL},
    {offsetof(struct homing, rightmax_written), 1U, sizeof(void *), NULL},
    {offsetof(struct homing, control), 1U, sizeof(void *), NULL},
    {offsetof(struct homing, feedback), 1U, sizeof(csp_sampled_end), &pointers_of_csp_sampled_end},
    {
        offsetof(struct homing, servo), 1U, sizeof(struct position_controller),
        &pointers_of_position_controller
    },
    {
        offsetof(struct homing, repeat_servo_branch), 1U, sizeof(csp_process),
        &pointers_of_csp_process
    },
    {
        offsetof(struct homing, interrupt_repeat_servo), 1U, sizeof(csp_interrupt),
        &pointers_of_csp_interrupt
    }
};
static const csp_pointers pointers_of_homing = {pointers_of_homing_members, 11U};

static const csp_pointer_member pointers_of_joint_control_members[] = {
    {offsetof(struct joint_control, process), 1U, sizeof(csp_process), &pointers_of_csp_process},
    {offsetof(struct joint_control, alignL), 1U, sizeof(struct align), &pointers_of_align},
    {offsetof(struct joint_control, alignR), 1U, sizeof(struct align), &pointers_of_align},
    {
        offsetof(struct joint_control, motionControl), 1U, sizeof(struct motion_control),
        &pointers_of_motion_control
    },
    {offsetof(struct joint_control, homing), 1U, sizeof(struct homing), &pointers_of_homing}
};
static const csp_pointers pointers_of_joint_control = {pointers_of_joint_control_members, 5U};

static const csp_pointer_member pointers_of_jiwy_members[] = {
    {offsetof(struct jiwy, process), 1U, sizeof(csp_process), &pointers_of_csp_process},
    {
        offsetof(struct jiwy, horizontal), 1U, sizeof(struct joint_control),
        &pointers_of_joint_control
    },
    {offsetof(struct jiwy, vertical), 1U, sizeof(struct joint_control), &pointers_of_joint_control},
    {offsetof(struct jiwy, parallel), 1U, sizeof(csp_parallel), &pointers_of_csp_parallel}
};
static const csp_pointers pointers_of_jiwy = {pointers_of_jiwy_members, 4U};

static const csp_pointer_member pointers_of_csp_driver_members[] = {
    {offsetof(csp_driver, device), 1U, sizeof(void *), NULL},
    {offsetof(csp_driver, read), 1U, sizeof(void *), NULL},
    {offsetof(csp_driver, write), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_driver = {pointers_of_csp_driver_members, 3U};

static const csp_pointer_member pointers_of_csp_sampled_input_members[] = {
    {offsetof(csp_sampled_input, driver), 1U, sizeof(csp_driver), &pointers_of_csp_driver},
    {offsetof(csp_sampled_input, value), 1U, sizeof(void *), NULL},
    {offsetof(csp_sampled_input, ends), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_sampled_input =
    {pointers_of_csp_sampled_input_members, 3U};

static const csp_pointer_member pointers_of_csp_event_input_members[] = {
    {offsetof(csp_event_input, driver), 1U, sizeof(csp_driver), &pointers_of_csp_driver},
    {offsetof(csp_event_input, value), 1U, sizeof(void *), NULL},
    {offsetof(csp_event_input, brought), 1U, sizeof(void *), NULL},
    {offsetof(csp_event_input, ends), 1U, sizeof(void *), NULL},
    {offsetof(csp_event_input, shared), 1U, sizeof(csp_event_end), &pointers_of_csp_event_end}
};
static const csp_pointers pointers_of_csp_event_input = {pointers_of_csp_event_input_members, 5U};

static const csp_pointer_member pointers_of_csp_latched_output_members[] = {
    {offsetof(csp_latched_output, name), 1U, sizeof(void *), NULL},
    {offsetof(csp_latched_output, driver), 1U, sizeof(csp_driver), &pointers_of_csp_driver},
    {offsetof(csp_latched_output, value), 1U, sizeof(void *), NULL}
};
static const csp_pointers pointers_of_csp_latched_output =
    {pointers_of_csp_latched_output_members, 3U};

static const csp_pointer_member network_pointers_members[] = {
    {offsetof(struct network, kernel), 1U, sizeof(csp_kernel), &pointers_of_csp_kernel},
    {offsetof(struct network, top), 1U, sizeof(struct jiwy), &pointers_of_jiwy},
    {
        offsetof(struct network, external.joystick_horizontal), 1U, sizeof(csp_sampled_input),
        &pointers_of_csp_sampled_input
    },
    {
        offsetof(struct network, external.joystick_vertical), 1U, sizeof(csp_sampled_input),
        &pointers_of_csp_sampled_input
    },
    {
        offsetof(struct network, external.joystick_buttons), 1U, sizeof(csp_event_input),
        &pointers_of_csp_event_input
    },
    {
        offsetof(struct network, external.feedback_horizontal), 1U, sizeof(csp_sampled_input),
        &pointers_of_csp_sampled_input
    },
    {
        offsetof(struct network, external.feedback_vertical), 1U, sizeof(csp_sampled_input),
        &pointers_of_csp_sampled_input
    },
    {
        offsetof(struct network, external.control_horizontal), 1U, sizeof(csp_latched_output),
        &pointers_of_csp_latched_output
    },
    {
        offsetof(struct network, external.control_vertical), 1U, sizeof(csp_latched_output),
        &pointers_of_csp_latched_output
    }
};
const csp_pointers network_pointers = {network_pointers_members, 9U};
