/* SPDX-License-Identifier: 0BSD */
#include "network.h"

#if CSP_TRACE || CSP_MEASURE || CSP_TRACE_HOOK
const uint32_t network_channel_count = 7U;
const char *const network_channel_names[] = {
    "Jiwy.joystick_horizontal",
    "Jiwy.joystick_vertical",
    "Jiwy.joystick_buttons",
    "Jiwy.feedback_horizontal",
    "Jiwy.feedback_vertical",
    "Jiwy.control_horizontal",
    "Jiwy.control_vertical",
};
const uint32_t network_channel_sizes[] = {
    sizeof(double),
    sizeof(double),
    sizeof(int64_t),
    sizeof(double),
    sizeof(double),
    sizeof(double),
    sizeof(double),
};

/* Numbers of processes and groups count from 1; a group has no kind. */
const uint32_t network_process_count = 11U;
const char *const network_process_names[] = {
    "",
    "Jiwy",
    "Jiwy.horizontal",
    "Jiwy.horizontal.alignL",
    "Jiwy.horizontal.alignR",
    "Jiwy.horizontal.motionControl",
    "Jiwy.horizontal.homing",
    "Jiwy.vertical",
    "Jiwy.vertical.alignL",
    "Jiwy.vertical.alignR",
    "Jiwy.vertical.motionControl",
    "Jiwy.vertical.homing",
};
const char *const network_process_kinds[] = {
    "",
    "Jiwy",
    "JointControl",
    "Align",
    "Align",
    "MotionControl",
    "Homing",
    "JointControl",
    "Align",
    "Align",
    "MotionControl",
    "Homing",
};
#else
typedef int network_has_no_names;
#endif

/* Variables that may be read before they were written. */
const char *const network_variable_names[] = {
    "Jiwy.horizontal.leftmax",
    "Jiwy.horizontal.rightmax",
    "Jiwy.vertical.leftmax",
    "Jiwy.vertical.rightmax",
};
