/* SPDX-License-Identifier: 0BSD */
/* One joint through its four modes.
 *
 * Source: jiwy.csp:104
 */
#ifndef JOINT_CONTROL_H
#define JOINT_CONTROL_H

#include "csp.h"
#include "types.h"

/* What the ports are connected to. */
struct joint_control_ports {
    csp_sampled_input *feedback;
    csp_sampled_input *joystick_axis;
    csp_event_input *joystick_buttons;
    csp_latched_output *control;
};

struct joint_control {
    csp_process process;
    csp_ends alignL_samples;
    csp_ends alignR_samples;
    csp_ends motionControl_samples;
    csp_ends homing_samples;
    const struct jiwy_servo_gains *gains;
    double alignKp;
    csp_latched_output *control;
    csp_sampled_end alignL_feedback;
    csp_sampled_end alignR_feedback;
    csp_event_end *joystick_buttons;
    /* if it has one of its own */
    csp_event_end joystick_buttons_latch;
    csp_sampled_end motionControl_feedback;
    csp_sampled_end motionControl_joystick_axis;
    csp_sampled_end homing_feedback;
    double leftmax;
    csp_written leftmax_written;
    double rightmax;
    csp_written rightmax_written;
    bool alignL_failed;
    bool alignL_stop;
    bool alignR_failed;
    bool alignR_stop;
    int64_t motionControl_status;
    bool motionControl_failed;
    double motionControl_reference;
    bool homing_failed;
    bool homing_stop;
    double homing_reference;
    double alignL_velocity_sample;
    double alignR_velocity_sample;
    double motionControl_servo_sample;
    double homing_servo_sample;
    bool alignL_velocity_moving;
    double alignL_velocity_last;
    double alignL_velocity_filtered;
    double alignL_velocity_ui;
    double alignL_velocity_pressed;
    bool alignR_velocity_moving;
    double alignR_velocity_last;
    double alignR_velocity_filtered;
    double alignR_velocity_ui;
    double alignR_velocity_pressed;
    bool motionControl_servo_profile_moving;
    double motionControl_servo_profile_last;
    double motionControl_servo_pid_e1;
    double motionControl_servo_pid_ud;
    double motionControl_servo_pid_ui;
    double motionControl_servo_arrived;
    bool homing_servo_profile_moving;
    double homing_servo_profile_last;
    double homing_servo_pid_e1;
    double homing_servo_pid_ud;
    double homing_servo_pid_ui;
    double homing_servo_arrived;
    double alignL_velocity_feedback;
    double alignL_velocity_control;
    bool alignL_velocity_stop;
    double alignR_velocity_feedback;
    double alignR_velocity_control;
    bool alignR_velocity_stop;
    double motionControl_servo_leftmax;
    double motionControl_servo_rightmax;
    double motionControl_servo_feedback;
    double motionControl_servo_setpoint;
    double motionControl_servo_reference;
    double motionControl_servo_control;
    double homing_servo_leftmax;
    double homing_servo_rightmax;
    double homing_servo_feedback;
    double homing_servo_reference;
    double homing_servo_control;
    bool homing_servo_stop;
    struct {
        csp_alternative alternative;
        csp_guard guards[2];
    } motionControl_choice;
    union {
        double control;
    } sent;
    csp_process alignL_run_velocity_branch;
    csp_interrupt alignL_interrupt_run_velocity;
    csp_process alignR_run_velocity_branch;
    csp_interrupt alignR_interrupt_run_velocity;
    csp_offers offers;
    /* of parameters, which these values follow: */
    uint32_t motionControl_servo_changes;
    double motionControl_servo_pid_f;
    double motionControl_servo_pid_tauI;
    double motionControl_servo_sample_kp;
    double motionControl_servo_tauD_kp;
    double motionControl_servo_tauD_beta;
    csp_process homing_run_servo_branch;
    /* of parameters, which these values follow: */
    uint32_t homing_servo_changes;
    double homing_servo_pid_f;
    double homing_servo_pid_tauI;
    double homing_servo_sample_kp;
    double homing_servo_tauD_kp;
    double homing_servo_tauD_beta;
    csp_interrupt homing_interrupt_run_servo;
    csp_offer offers_made[2];
};

/* Before the program starts. */
void joint_control_initialize(struct joint_control *self, csp_numbers *numbers,
    const struct joint_control_ports *ports, int64_t T, const struct jiwy_servo_gains *gains,
    double alignKp);

#endif
