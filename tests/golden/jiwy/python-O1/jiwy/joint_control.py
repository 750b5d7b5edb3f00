"""The process JointControl."""

from __future__ import annotations

from math import isfinite

from .exceptions import ModeFailed
from .runtime import (
    After,
    Alternative,
    Cancelled,
    In,
    Inlined,
    Input,
    Parameter,
    Ready,
    Routine,
    SampledInput,
    SampledOutput,
    Steps,
    Task,
    Timeout,
    Variable,
    finite,
    interrupted,
    lower_bits,
    read_all,
)
from .types import ServoGains


class JointControl(Routine):
    """One joint through its four modes.

    Source: jiwy.csp:104

    Parameters:
        T: time, in nanoseconds.
        gains: ServoGains, which may change.
        alignKp: double<V*s/rad>.

    Ports:
        feedback: in, double<rad> @ T.
        joystick_axis: in, double @ T.
        joystick_buttons: in, int.
        control: out, double<V> @ T.
    """

    __slots__ = (
        "alignKp",
        "alignL_process",
        "alignL_velocity_law",
        "alignL_velocity_sample",
        "alignR_process",
        "alignR_velocity_law",
        "alignR_velocity_sample",
        "control",
        "feedback",
        "feedback_2",
        "feedback_3",
        "feedback_4",
        "gains",
        "homing_process",
        "homing_servo_law",
        "homing_servo_sample",
        "joystick_axis",
        "joystick_buttons",
        "leftmax",
        "motionControl_choice",
        "motionControl_process",
        "motionControl_servo_law",
        "motionControl_servo_sample",
        "rightmax",
    )

    kind = "JointControl"
    source = "jiwy.csp:104"
    checked = True

    def __init__(
        self,
        name: str,
        *,
        T: int,
        gains: Parameter[ServoGains],
        alignKp: float,
        feedback: SampledInput[float],
        joystick_axis: SampledInput[float],
        joystick_buttons: In[int],
        control: SampledOutput[float],
    ) -> None:
        super().__init__(name)
        self.gains = gains
        self.alignKp = alignKp
        self.control = control
        self.alignL_velocity_sample = T / 1_000_000_000  # jiwy.csp:29
        self.alignR_velocity_sample = T / 1_000_000_000  # jiwy.csp:29
        self.motionControl_servo_sample = T / 1_000_000_000  # jiwy.csp:54
        self.homing_servo_sample = T / 1_000_000_000  # jiwy.csp:82
        self.alignL_process = Inlined(f"{name}.alignL", "Align", source="jiwy.csp:129")
        self.alignR_process = Inlined(f"{name}.alignR", "Align", source="jiwy.csp:129")
        self.motionControl_process = Inlined(
            f"{name}.motionControl", "MotionControl", source="jiwy.csp:129"
        )
        self.homing_process = Inlined(f"{name}.homing", "Homing", source="jiwy.csp:129")
        self.alignL_velocity_law = Inlined(f"{name}.alignL.velocity", source="laws.csp:88")
        self.alignR_velocity_law = Inlined(f"{name}.alignR.velocity", source="laws.csp:88")
        self.motionControl_servo_law = Inlined(f"{name}.motionControl.servo", source="laws.csp:56")
        self.homing_servo_law = Inlined(f"{name}.homing.servo", source="laws.csp:56")
        self.leftmax = Variable[float](f"{name}.leftmax")
        self.rightmax = Variable[float](f"{name}.rightmax")
        self.feedback = feedback.reader(self.alignL_process)
        self.feedback_2 = feedback.reader(self.alignR_process)
        self.joystick_buttons = joystick_buttons.reader(self)
        self.feedback_3 = feedback.reader(self.motionControl_process)
        self.joystick_axis = joystick_axis.reader(self.motionControl_process)
        self.motionControl_choice = Alternative(
            Input(self.joystick_buttons), Ready(self.feedback_3), prioritized=True
        )
        self.feedback_4 = feedback.reader(self.homing_process)

    def steps(self, me: Task) -> Steps:
        scheduler = me.scheduler
        observe = scheduler.observe
        alignL_process = self.alignL_process
        alignL_velocity_law = self.alignL_velocity_law
        feedback = self.feedback
        alignL_velocity_sample = self.alignL_velocity_sample
        alignKp = self.alignKp
        control = self.control
        leftmax = self.leftmax
        alignR_process = self.alignR_process
        alignR_velocity_law = self.alignR_velocity_law
        feedback_2 = self.feedback_2
        alignR_velocity_sample = self.alignR_velocity_sample
        rightmax = self.rightmax
        motionControl_process = self.motionControl_process
        motionControl_choice = self.motionControl_choice
        joystick_buttons = self.joystick_buttons
        motionControl_servo_law = self.motionControl_servo_law
        feedback_3 = self.feedback_3
        joystick_axis = self.joystick_axis
        gains = self.gains
        motionControl_servo_sample = self.motionControl_servo_sample
        homing_process = self.homing_process
        homing_servo_law = self.homing_servo_law
        feedback_4 = self.feedback_4
        homing_servo_sample = self.homing_servo_sample
        motionControl_choice_guards = motionControl_choice.selector
        motionControl_servo_pid_tauD: float
        motionControl_servo_pid_beta: float
        motionControl_servo_pid_f: float
        motionControl_servo_pid_kp: float
        motionControl_servo_pid_tauI: float
        motionControl_servo_sample_kp: float
        motionControl_servo_tauD_kp: float
        motionControl_servo_tauD_beta: float
        motionControl_servo_gains_tolerance: float
        motionControl_servo_gains_friction: float
        motionControl_servo_gains: ServoGains | None = None
        homing_servo_pid_tauD: float
        homing_servo_pid_beta: float
        homing_servo_pid_f: float
        homing_servo_pid_kp: float
        homing_servo_pid_tauI: float
        homing_servo_sample_kp: float
        homing_servo_tauD_kp: float
        homing_servo_tauD_beta: float
        homing_servo_gains_tolerance: float
        homing_servo_gains_friction: float
        homing_servo_gains: ServoGains | None = None
        alignL_velocity_moving: bool = False  # laws.csp:97
        alignL_velocity_last: float = 0.0  # laws.csp:98
        alignL_velocity_filtered: float = 0.0  # laws.csp:99
        alignL_velocity_ui: float = 0.0  # laws.csp:100
        alignL_velocity_pressed: float = 0.0  # laws.csp:101
        alignR_velocity_moving: bool = False  # laws.csp:97
        alignR_velocity_last: float = 0.0  # laws.csp:98
        alignR_velocity_filtered: float = 0.0  # laws.csp:99
        alignR_velocity_ui: float = 0.0  # laws.csp:100
        alignR_velocity_pressed: float = 0.0  # laws.csp:101
        motionControl_servo_profile_moving: bool = False  # laws.csp:32
        motionControl_servo_profile_last: float = 0.0  # laws.csp:33
        motionControl_servo_pid_e1: float = 0.0  # laws.csp:10
        motionControl_servo_pid_ud: float = 0.0  # laws.csp:11
        motionControl_servo_pid_ui: float = 0.0  # laws.csp:12
        motionControl_servo_arrived: float = 0.0  # laws.csp:69
        homing_servo_profile_moving: bool = False  # laws.csp:32
        homing_servo_profile_last: float = 0.0  # laws.csp:33
        homing_servo_pid_e1: float = 0.0  # laws.csp:10
        homing_servo_pid_ud: float = 0.0  # laws.csp:11
        homing_servo_pid_ui: float = 0.0  # laws.csp:12
        homing_servo_arrived: float = 0.0  # laws.csp:69
        alignL_failed: bool = False
        alignL_stop: bool
        alignR_failed: bool = False
        alignR_stop: bool
        homing_failed: bool = False
        homing_reference: float
        homing_stop: bool
        motionControl_failed: bool = False
        motionControl_reference: float
        motionControl_status: int = 0

        def _run_velocity(me: Task) -> Steps:
            nonlocal alignL_stop, alignL_velocity_filtered, alignL_velocity_last
            nonlocal alignL_velocity_moving, alignL_velocity_pressed, alignL_velocity_ui
            me.process = alignL_velocity_law
            while True:
                try:
                    # laws.csp:88  inputs of alignL.velocity
                    if me.cancelled:
                        raise Cancelled
                    if not feedback.fresh:
                        if feedback.steady and feedback.waiter is None:
                            me.waiting = feedback
                            feedback.waiter = me
                        else:
                            feedback.wait(me)
                        yield
                        if me.cancelled:
                            raise Cancelled
                    if feedback.steady:
                        feedback.fresh = False
                        alignL_velocity_feedback = feedback.value
                        if feedback.inputs:
                            lower_bits(feedback.inputs)
                        if observe is not None:
                            observe(feedback.name, alignL_velocity_feedback, None, me)
                    else:
                        alignL_velocity_feedback = feedback.taken(me)
                    # laws.csp:103
                    alignL_velocity_difference = (
                        (alignL_velocity_feedback - alignL_velocity_last) / alignL_velocity_sample
                        if alignL_velocity_moving
                        else 0.0
                    )
                    # laws.csp:104
                    alignL_velocity_velocity = alignL_velocity_filtered + alignL_velocity_sample / (
                        0.02 + alignL_velocity_sample
                    ) * (alignL_velocity_difference - alignL_velocity_filtered)
                    alignL_velocity_error = -1.0 - alignL_velocity_velocity  # laws.csp:105
                    # laws.csp:106
                    alignL_velocity_i = (
                        alignL_velocity_ui + alignL_velocity_sample * 2.2 * alignL_velocity_error
                    )
                    # laws.csp:107
                    alignL_velocity_sum = alignKp * alignL_velocity_error + alignL_velocity_i
                    # laws.csp:109
                    alignL_velocity_control = (
                        -1.5
                        if alignL_velocity_sum < -1.5
                        else 1.5
                        if alignL_velocity_sum > 1.5
                        else alignL_velocity_sum
                    )
                    # laws.csp:115
                    alignL_velocity_pressing = (
                        alignL_velocity_velocity < 0.1
                        and alignL_velocity_velocity > -0.1
                        and -alignL_velocity_control > 0.9
                    )
                    # laws.csp:116
                    alignL_velocity_held = (
                        alignL_velocity_pressed + alignL_velocity_sample
                        if alignL_velocity_pressing
                        else 0.0
                    )
                    alignL_velocity_stop = alignL_velocity_held >= 0.1  # laws.csp:118
                    alignL_velocity_filtered_next = alignL_velocity_velocity  # laws.csp:112
                    # laws.csp:113
                    alignL_velocity_ui_next = (
                        alignL_velocity_i
                        if alignL_velocity_sum == alignL_velocity_control
                        else alignL_velocity_ui
                    )
                    alignL_velocity_pressed_next = alignL_velocity_held  # laws.csp:117
                    if not isfinite(
                        alignL_velocity_control
                        + alignL_velocity_filtered_next
                        + alignL_velocity_ui_next
                        + alignL_velocity_pressed_next,
                    ):
                        finite(alignL_velocity_control)  # laws.csp:109
                        finite(alignL_velocity_filtered_next)  # laws.csp:112
                        finite(alignL_velocity_ui_next)  # laws.csp:113
                        finite(alignL_velocity_pressed_next)  # laws.csp:117
                    alignL_velocity_moving = True  # laws.csp:110
                    alignL_velocity_last = alignL_velocity_feedback  # laws.csp:111
                    alignL_velocity_filtered = alignL_velocity_filtered_next  # laws.csp:112
                    alignL_velocity_ui = alignL_velocity_ui_next  # laws.csp:113
                    alignL_velocity_pressed = alignL_velocity_pressed_next  # laws.csp:117
                    # laws.csp:88  outputs of alignL.velocity
                    if me.cancelled:
                        raise Cancelled
                    control.latched = alignL_velocity_control
                    control.writer = me
                    control.written = True
                    leftmax.value = alignL_velocity_feedback
                    alignL_stop = alignL_velocity_stop
                except Exception as error:
                    me.process = alignL_process
                    alignL_velocity_law.blame(error)
                    raise
                if alignL_stop:
                    break
            me.process = alignL_process

        def _run_velocity_(me: Task) -> Steps:
            nonlocal alignR_stop, alignR_velocity_filtered, alignR_velocity_last
            nonlocal alignR_velocity_moving, alignR_velocity_pressed, alignR_velocity_ui
            me.process = alignR_velocity_law
            while True:
                try:
                    # laws.csp:88  inputs of alignR.velocity
                    if me.cancelled:
                        raise Cancelled
                    if not feedback_2.fresh:
                        if feedback_2.steady and feedback_2.waiter is None:
                            me.waiting = feedback_2
                            feedback_2.waiter = me
                        else:
                            feedback_2.wait(me)
                        yield
                        if me.cancelled:
                            raise Cancelled
                    if feedback_2.steady:
                        feedback_2.fresh = False
                        alignR_velocity_feedback = feedback_2.value
                        if feedback_2.inputs:
                            lower_bits(feedback_2.inputs)
                        if observe is not None:
                            observe(feedback_2.name, alignR_velocity_feedback, None, me)
                    else:
                        alignR_velocity_feedback = feedback_2.taken(me)
                    # laws.csp:103
                    alignR_velocity_difference = (
                        (alignR_velocity_feedback - alignR_velocity_last) / alignR_velocity_sample
                        if alignR_velocity_moving
                        else 0.0
                    )
                    # laws.csp:104
                    alignR_velocity_velocity = alignR_velocity_filtered + alignR_velocity_sample / (
                        0.02 + alignR_velocity_sample
                    ) * (alignR_velocity_difference - alignR_velocity_filtered)
                    alignR_velocity_error = 1.0 - alignR_velocity_velocity  # laws.csp:105
                    # laws.csp:106
                    alignR_velocity_i = (
                        alignR_velocity_ui + alignR_velocity_sample * 2.2 * alignR_velocity_error
                    )
                    # laws.csp:107
                    alignR_velocity_sum = alignKp * alignR_velocity_error + alignR_velocity_i
                    # laws.csp:109
                    alignR_velocity_control = (
                        -1.5
                        if alignR_velocity_sum < -1.5
                        else 1.5
                        if alignR_velocity_sum > 1.5
                        else alignR_velocity_sum
                    )
                    # laws.csp:115
                    alignR_velocity_pressing = (
                        alignR_velocity_velocity < 0.1
                        and alignR_velocity_velocity > -0.1
                        and alignR_velocity_control > 0.9
                    )
                    # laws.csp:116
                    alignR_velocity_held = (
                        alignR_velocity_pressed + alignR_velocity_sample
                        if alignR_velocity_pressing
                        else 0.0
                    )
                    alignR_velocity_stop = alignR_velocity_held >= 0.1  # laws.csp:118
                    alignR_velocity_filtered_next = alignR_velocity_velocity  # laws.csp:112
                    # laws.csp:113
                    alignR_velocity_ui_next = (
                        alignR_velocity_i
                        if alignR_velocity_sum == alignR_velocity_control
                        else alignR_velocity_ui
                    )
                    alignR_velocity_pressed_next = alignR_velocity_held  # laws.csp:117
                    if not isfinite(
                        alignR_velocity_control
                        + alignR_velocity_filtered_next
                        + alignR_velocity_ui_next
                        + alignR_velocity_pressed_next,
                    ):
                        finite(alignR_velocity_control)  # laws.csp:109
                        finite(alignR_velocity_filtered_next)  # laws.csp:112
                        finite(alignR_velocity_ui_next)  # laws.csp:113
                        finite(alignR_velocity_pressed_next)  # laws.csp:117
                    alignR_velocity_moving = True  # laws.csp:110
                    alignR_velocity_last = alignR_velocity_feedback  # laws.csp:111
                    alignR_velocity_filtered = alignR_velocity_filtered_next  # laws.csp:112
                    alignR_velocity_ui = alignR_velocity_ui_next  # laws.csp:113
                    alignR_velocity_pressed = alignR_velocity_pressed_next  # laws.csp:117
                    # laws.csp:88  outputs of alignR.velocity
                    if me.cancelled:
                        raise Cancelled
                    control.latched = alignR_velocity_control
                    control.writer = me
                    control.written = True
                    rightmax.value = alignR_velocity_feedback
                    alignR_stop = alignR_velocity_stop
                except Exception as error:
                    me.process = alignR_process
                    alignR_velocity_law.blame(error)
                    raise
                if alignR_stop:
                    break
            me.process = alignR_process

        def _run_servo(me: Task) -> Steps:
            nonlocal homing_reference, homing_servo_arrived, homing_servo_gains
            nonlocal homing_servo_gains_friction, homing_servo_gains_tolerance
            nonlocal homing_servo_pid_beta, homing_servo_pid_e1, homing_servo_pid_f
            nonlocal homing_servo_pid_kp, homing_servo_pid_tauD, homing_servo_pid_tauI
            nonlocal homing_servo_pid_ud, homing_servo_pid_ui, homing_servo_profile_last
            nonlocal homing_servo_profile_moving, homing_servo_sample_kp, homing_servo_tauD_beta
            nonlocal homing_servo_tauD_kp, homing_stop
            me.process = homing_servo_law
            while True:
                try:
                    # laws.csp:56  inputs of homing.servo
                    if me.cancelled:
                        raise Cancelled
                    homing_servo_leftmax = leftmax.value
                    homing_servo_rightmax = rightmax.value
                    if me.cancelled:
                        raise Cancelled
                    if not feedback_4.fresh:
                        if feedback_4.steady and feedback_4.waiter is None:
                            me.waiting = feedback_4
                            feedback_4.waiter = me
                        else:
                            feedback_4.wait(me)
                        yield
                        if me.cancelled:
                            raise Cancelled
                    if feedback_4.steady:
                        feedback_4.fresh = False
                        homing_servo_feedback = feedback_4.value
                        if feedback_4.inputs:
                            lower_bits(feedback_4.inputs)
                        if observe is not None:
                            observe(feedback_4.name, homing_servo_feedback, None, me)
                    else:
                        homing_servo_feedback = feedback_4.taken(me)
                    if gains.value is not homing_servo_gains:
                        homing_servo_pid_tauD = gains.value.tauD / 1_000_000_000  # laws.csp:6
                        homing_servo_pid_beta = gains.value.beta  # laws.csp:6
                        # laws.csp:14
                        homing_servo_pid_f = 1.0 / (
                            homing_servo_sample + homing_servo_pid_tauD * homing_servo_pid_beta
                        )
                        homing_servo_pid_kp = gains.value.kp  # laws.csp:6
                        homing_servo_pid_tauI = gains.value.tauI / 1_000_000_000  # laws.csp:6
                        homing_servo_sample_kp = homing_servo_sample * homing_servo_pid_kp
                        homing_servo_tauD_kp = homing_servo_pid_tauD * homing_servo_pid_kp
                        homing_servo_tauD_beta = homing_servo_pid_tauD * homing_servo_pid_beta
                        homing_servo_gains_tolerance = gains.value.tolerance
                        homing_servo_gains_friction = gains.value.friction
                        homing_servo_gains = gains.value
                    # laws.csp:71
                    homing_servo_centre = (homing_servo_leftmax + homing_servo_rightmax) / 2.0
                    # laws.csp:72
                    homing_servo_reference = (
                        x2
                        if (x1 := homing_servo_centre + 0.0) < (x2 := homing_servo_leftmax + 0.05)
                        else x3
                        if x1 > (x3 := homing_servo_rightmax - 0.05)
                        else x1
                    )
                    # laws.csp:35
                    homing_servo_profile_from = (
                        homing_servo_profile_last
                        if homing_servo_profile_moving
                        else homing_servo_feedback
                    )
                    # laws.csp:36
                    homing_servo_profile_velocity = (
                        -6.0
                        if (x1 := (homing_servo_reference - homing_servo_profile_from) / 0.05)
                        < -6.0
                        else 6.0
                        if x1 > 6.0
                        else x1
                    )
                    # laws.csp:37
                    homing_servo_profile_angle = (
                        homing_servo_profile_from
                        + homing_servo_sample * homing_servo_profile_velocity
                    )
                    # laws.csp:75
                    homing_servo_pid_error = homing_servo_profile_angle - homing_servo_feedback
                    # laws.csp:15
                    homing_servo_pid_d = homing_servo_pid_f * (
                        homing_servo_tauD_beta * homing_servo_pid_ud
                        + homing_servo_tauD_kp * (homing_servo_pid_error - homing_servo_pid_e1)
                        + homing_servo_sample_kp * homing_servo_pid_error
                    )
                    if homing_servo_reference - homing_servo_reference != 0.0:
                        finite(homing_servo_reference)  # laws.csp:72
                    # laws.csp:16
                    homing_servo_pid_i = (
                        homing_servo_pid_ui
                        + homing_servo_sample * homing_servo_pid_d / homing_servo_pid_tauI
                    )
                    homing_servo_pid_sum = homing_servo_pid_i + homing_servo_pid_d  # laws.csp:17
                    # laws.csp:19
                    homing_servo_pid_output = (
                        -0.99
                        if homing_servo_pid_sum < -0.99
                        else 0.99
                        if homing_servo_pid_sum > 0.99
                        else homing_servo_pid_sum
                    )
                    # laws.csp:77
                    homing_servo_assistance = homing_servo_gains_friction * (
                        -1.0
                        if (x1 := homing_servo_profile_velocity / 0.05) < -1.0
                        else 1.0
                        if x1 > 1.0
                        else x1
                    )
                    # laws.csp:78
                    homing_servo_control = (
                        -12.0
                        if (x1 := 12.0 * homing_servo_pid_output + homing_servo_assistance) < -12.0
                        else 12.0
                        if x1 > 12.0
                        else x1
                    )
                    # laws.csp:80
                    homing_servo_standing = (
                        homing_servo_arrived + homing_servo_sample
                        if (x1 := homing_servo_reference - homing_servo_feedback)
                        < homing_servo_gains_tolerance
                        and x1 > -homing_servo_gains_tolerance
                        else 0.0
                    )
                    homing_servo_stop = homing_servo_standing >= 0.1  # laws.csp:82
                    homing_servo_profile_last_next = homing_servo_profile_angle  # laws.csp:39
                    homing_servo_pid_e1_next = homing_servo_pid_error  # laws.csp:20
                    homing_servo_pid_ud_next = homing_servo_pid_d  # laws.csp:21
                    # laws.csp:22
                    homing_servo_pid_ui_next = (
                        homing_servo_pid_i
                        if homing_servo_pid_sum == homing_servo_pid_output
                        else homing_servo_pid_ui
                    )
                    homing_servo_arrived_next = homing_servo_standing  # laws.csp:81
                    if not isfinite(
                        homing_servo_control
                        + homing_servo_profile_last_next
                        + homing_servo_pid_e1_next
                        + homing_servo_pid_ud_next
                        + homing_servo_pid_ui_next
                        + homing_servo_arrived_next,
                    ):
                        finite(homing_servo_control)  # laws.csp:78
                        finite(homing_servo_profile_last_next)  # laws.csp:39
                        finite(homing_servo_pid_e1_next)  # laws.csp:20
                        finite(homing_servo_pid_ud_next)  # laws.csp:21
                        finite(homing_servo_pid_ui_next)  # laws.csp:22
                        finite(homing_servo_arrived_next)  # laws.csp:81
                    homing_servo_profile_moving = True  # laws.csp:38
                    homing_servo_profile_last = homing_servo_profile_last_next  # laws.csp:39
                    homing_servo_pid_e1 = homing_servo_pid_e1_next  # laws.csp:20
                    homing_servo_pid_ud = homing_servo_pid_ud_next  # laws.csp:21
                    homing_servo_pid_ui = homing_servo_pid_ui_next  # laws.csp:22
                    homing_servo_arrived = homing_servo_arrived_next  # laws.csp:81
                    # laws.csp:56  outputs of homing.servo
                    if me.cancelled:
                        raise Cancelled
                    control.latched = homing_servo_control
                    control.writer = me
                    control.written = True
                    homing_reference = homing_servo_reference
                    homing_stop = homing_servo_stop
                except Exception as error:
                    me.process = homing_process
                    homing_servo_law.blame(error)
                    raise
                if homing_stop:
                    break
            me.process = homing_process

        self.start(me)
        try:
            # jiwy.csp:129  alignL
            alignL_process.start(me)
            try:
                try:
                    # jiwy.csp:39  (mu velocity until stop) interrupt after patience -> failed :=...
                    scheduler.current = me
                    guard_ = After(10_000_000_000)
                    if (yield from interrupted(_run_velocity, guard_)):
                        alignL_failed = True  # jiwy.csp:39
                except Timeout:
                    alignL_failed = True  # jiwy.csp:39
                # jiwy.csp:40  control ! 0<V>
                if me.cancelled:
                    raise Cancelled
                control.offer(me, 0.0)
                if alignL_failed:
                    raise ModeFailed  # jiwy.csp:41
            except BaseException as error:
                alignL_process.fail(me, error)
                raise
            alignL_process.end(me)
            # jiwy.csp:129  alignR
            alignR_process.start(me)
            try:
                try:
                    # jiwy.csp:39  (mu velocity until stop) interrupt after patience -> failed :=...
                    scheduler.current = me
                    guard_3 = After(10_000_000_000)
                    if (yield from interrupted(_run_velocity_, guard_3)):
                        alignR_failed = True  # jiwy.csp:39
                except Timeout:
                    alignR_failed = True  # jiwy.csp:39
                # jiwy.csp:40  control ! 0<V>
                if me.cancelled:
                    raise Cancelled
                control.offer(me, 0.0)
                if alignR_failed:
                    raise ModeFailed  # jiwy.csp:41
            except BaseException as error:
                alignR_process.fail(me, error)
                raise
            alignR_process.end(me)
            # jiwy.csp:129  motionControl
            motionControl_process.start(me)
            try:
                try:
                    while True:
                        # jiwy.csp:68  joystick_buttons ? status -> skip []> feedback -> servo
                        if me.cancelled:
                            raise Cancelled
                        ready = motionControl_choice_guards.ready
                        while not ready:
                            if motionControl_choice_guards.attend:
                                scheduler.current = me
                                ready = yield from motionControl_choice.wait(-1)
                            else:
                                motionControl_choice.park(me, -1)
                                yield
                                motionControl_choice_guards.waiting = None
                                if me.cancelled:
                                    raise Cancelled
                                ready = motionControl_choice_guards.ready
                        k = (ready & -ready).bit_length() - 1
                        if k == 0:  # joystick_buttons ? status
                            scheduler.current = me
                            motionControl_status = joystick_buttons.take()
                        else:  # feedback
                            me.process = motionControl_servo_law
                            try:
                                # laws.csp:56  inputs of motionControl.servo
                                if me.cancelled:
                                    raise Cancelled
                                motionControl_servo_leftmax = leftmax.value
                                motionControl_servo_rightmax = rightmax.value
                                if feedback_3.fresh and joystick_axis.fresh:
                                    if feedback_3.steady:
                                        feedback_3.fresh = False
                                        motionControl_servo_feedback = feedback_3.value
                                        if feedback_3.inputs:
                                            lower_bits(feedback_3.inputs)
                                        if observe is not None:
                                            observe(
                                                feedback_3.name,
                                                motionControl_servo_feedback,
                                                None,
                                                me,
                                            )
                                    else:
                                        motionControl_servo_feedback = feedback_3.taken(me)
                                    if joystick_axis.steady:
                                        joystick_axis.fresh = False
                                        motionControl_servo_setpoint = joystick_axis.value
                                        if observe is not None:
                                            observe(
                                                joystick_axis.name,
                                                motionControl_servo_setpoint,
                                                None,
                                                me,
                                            )
                                    else:
                                        motionControl_servo_setpoint = joystick_axis.taken(me)
                                else:
                                    scheduler.current = me
                                    (
                                        motionControl_servo_feedback,
                                        motionControl_servo_setpoint,
                                    ) = yield from read_all(feedback_3, joystick_axis)
                                if gains.value is not motionControl_servo_gains:
                                    # laws.csp:6
                                    motionControl_servo_pid_tauD = gains.value.tauD / 1_000_000_000
                                    motionControl_servo_pid_beta = gains.value.beta  # laws.csp:6
                                    # laws.csp:14
                                    motionControl_servo_pid_f = 1.0 / (
                                        motionControl_servo_sample
                                        + motionControl_servo_pid_tauD
                                        * motionControl_servo_pid_beta
                                    )
                                    motionControl_servo_pid_kp = gains.value.kp  # laws.csp:6
                                    # laws.csp:6
                                    motionControl_servo_pid_tauI = gains.value.tauI / 1_000_000_000
                                    motionControl_servo_sample_kp = (
                                        motionControl_servo_sample * motionControl_servo_pid_kp
                                    )
                                    motionControl_servo_tauD_kp = (
                                        motionControl_servo_pid_tauD * motionControl_servo_pid_kp
                                    )
                                    motionControl_servo_tauD_beta = (
                                        motionControl_servo_pid_tauD * motionControl_servo_pid_beta
                                    )
                                    motionControl_servo_gains_tolerance = gains.value.tolerance
                                    motionControl_servo_gains_friction = gains.value.friction
                                    motionControl_servo_gains = gains.value
                                # laws.csp:71
                                motionControl_servo_centre = (
                                    motionControl_servo_leftmax + motionControl_servo_rightmax
                                ) / 2.0
                                # laws.csp:72
                                motionControl_servo_reference = (
                                    x2
                                    if (
                                        x1 := motionControl_servo_centre
                                        + 1.25 * motionControl_servo_setpoint
                                    )
                                    < (x2 := motionControl_servo_leftmax + 0.05)
                                    else x3
                                    if x1 > (x3 := motionControl_servo_rightmax - 0.05)
                                    else x1
                                )
                                # laws.csp:35
                                motionControl_servo_profile_from = (
                                    motionControl_servo_profile_last
                                    if motionControl_servo_profile_moving
                                    else motionControl_servo_feedback
                                )
                                # laws.csp:36
                                motionControl_servo_profile_velocity = (
                                    -6.0
                                    if (
                                        x1 := (
                                            motionControl_servo_reference
                                            - motionControl_servo_profile_from
                                        )
                                        / 0.05
                                    )
                                    < -6.0
                                    else 6.0
                                    if x1 > 6.0
                                    else x1
                                )
                                # laws.csp:37
                                motionControl_servo_profile_angle = (
                                    motionControl_servo_profile_from
                                    + motionControl_servo_sample
                                    * motionControl_servo_profile_velocity
                                )
                                # laws.csp:75
                                motionControl_servo_pid_error = (
                                    motionControl_servo_profile_angle - motionControl_servo_feedback
                                )
                                # laws.csp:15
                                motionControl_servo_pid_d = motionControl_servo_pid_f * (
                                    motionControl_servo_tauD_beta * motionControl_servo_pid_ud
                                    + motionControl_servo_tauD_kp
                                    * (motionControl_servo_pid_error - motionControl_servo_pid_e1)
                                    + motionControl_servo_sample_kp * motionControl_servo_pid_error
                                )
                                if (
                                    motionControl_servo_reference - motionControl_servo_reference
                                    != 0.0
                                ):
                                    finite(motionControl_servo_reference)  # laws.csp:72
                                # laws.csp:16
                                motionControl_servo_pid_i = (
                                    motionControl_servo_pid_ui
                                    + motionControl_servo_sample
                                    * motionControl_servo_pid_d
                                    / motionControl_servo_pid_tauI
                                )
                                # laws.csp:17
                                motionControl_servo_pid_sum = (
                                    motionControl_servo_pid_i + motionControl_servo_pid_d
                                )
                                # laws.csp:19
                                motionControl_servo_pid_output = (
                                    -0.99
                                    if motionControl_servo_pid_sum < -0.99
                                    else 0.99
                                    if motionControl_servo_pid_sum > 0.99
                                    else motionControl_servo_pid_sum
                                )
                                # laws.csp:77
                                motionControl_servo_assistance = (
                                    motionControl_servo_gains_friction
                                    * (
                                        -1.0
                                        if (x1 := motionControl_servo_profile_velocity / 0.05)
                                        < -1.0
                                        else 1.0
                                        if x1 > 1.0
                                        else x1
                                    )
                                )
                                # laws.csp:78
                                motionControl_servo_control = (
                                    -12.0
                                    if (
                                        x1 := 12.0 * motionControl_servo_pid_output
                                        + motionControl_servo_assistance
                                    )
                                    < -12.0
                                    else 12.0
                                    if x1 > 12.0
                                    else x1
                                )
                                # laws.csp:80
                                motionControl_servo_standing = (
                                    motionControl_servo_arrived + motionControl_servo_sample
                                    if (
                                        x1 := motionControl_servo_reference
                                        - motionControl_servo_feedback
                                    )
                                    < motionControl_servo_gains_tolerance
                                    and x1 > -motionControl_servo_gains_tolerance
                                    else 0.0
                                )
                                # laws.csp:39
                                motionControl_servo_profile_last_next = (
                                    motionControl_servo_profile_angle
                                )
                                # laws.csp:20
                                motionControl_servo_pid_e1_next = motionControl_servo_pid_error
                                # laws.csp:21
                                motionControl_servo_pid_ud_next = motionControl_servo_pid_d
                                # laws.csp:22
                                motionControl_servo_pid_ui_next = (
                                    motionControl_servo_pid_i
                                    if motionControl_servo_pid_sum == motionControl_servo_pid_output
                                    else motionControl_servo_pid_ui
                                )
                                # laws.csp:81
                                motionControl_servo_arrived_next = motionControl_servo_standing
                                if not isfinite(
                                    motionControl_servo_control
                                    + motionControl_servo_profile_last_next
                                    + motionControl_servo_pid_e1_next
                                    + motionControl_servo_pid_ud_next
                                    + motionControl_servo_pid_ui_next
                                    + motionControl_servo_arrived_next,
                                ):
                                    finite(motionControl_servo_control)  # laws.csp:78
                                    finite(motionControl_servo_profile_last_next)  # laws.csp:39
                                    finite(motionControl_servo_pid_e1_next)  # laws.csp:20
                                    finite(motionControl_servo_pid_ud_next)  # laws.csp:21
                                    finite(motionControl_servo_pid_ui_next)  # laws.csp:22
                                    finite(motionControl_servo_arrived_next)  # laws.csp:81
                                motionControl_servo_profile_moving = True  # laws.csp:38
                                # laws.csp:39
                                motionControl_servo_profile_last = (
                                    motionControl_servo_profile_last_next
                                )
                                # laws.csp:20
                                motionControl_servo_pid_e1 = motionControl_servo_pid_e1_next
                                # laws.csp:21
                                motionControl_servo_pid_ud = motionControl_servo_pid_ud_next
                                # laws.csp:22
                                motionControl_servo_pid_ui = motionControl_servo_pid_ui_next
                                # laws.csp:81
                                motionControl_servo_arrived = motionControl_servo_arrived_next
                                # laws.csp:56  outputs of motionControl.servo
                                if me.cancelled:
                                    raise Cancelled
                                control.latched = motionControl_servo_control
                                control.writer = me
                                control.written = True
                                motionControl_reference = motionControl_servo_reference
                            except Exception as error:
                                me.process = motionControl_process
                                motionControl_servo_law.blame(error)
                                raise
                            me.process = motionControl_process
                        if motionControl_status == 2:
                            break
                except Timeout:
                    motionControl_failed = True  # jiwy.csp:69
                # jiwy.csp:70  control ! 0<V>
                if me.cancelled:
                    raise Cancelled
                control.offer(me, 0.0)
                if motionControl_failed:
                    raise ModeFailed  # jiwy.csp:71
            except BaseException as error:
                motionControl_process.fail(me, error)
                raise
            motionControl_process.end(me)
            # jiwy.csp:129  homing
            homing_process.start(me)
            try:
                try:
                    # jiwy.csp:97  (mu servo until stop) interrupt after patience -> skip
                    scheduler.current = me
                    guard_4 = After(3_000_000_000)
                    yield from interrupted(_run_servo, guard_4)
                except Timeout:
                    homing_failed = True  # jiwy.csp:97
                # jiwy.csp:98  control ! 0<V>
                if me.cancelled:
                    raise Cancelled
                control.offer(me, 0.0)
                if homing_failed:
                    raise ModeFailed  # jiwy.csp:99
            except BaseException as error:
                homing_process.fail(me, error)
                raise
            homing_process.end(me)
        except BaseException as error:
            self.fail(me, error)
            raise
        self.end(me)
