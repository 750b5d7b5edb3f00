"""The submodel PositionController."""

from __future__ import annotations

from .constants import supply
from .runtime import In, Out, Parameter, Submodel, finite, limit, read_all, s, write_all
from .types import ServoGains


class PositionController(Submodel):
    """Position servo of one joint. The set-point counts from the centre between the end stops, 1
    being `reach`; `reference` is the angle that this means. The voltage for the friction is
    added in the direction in which the profile moves. `stop` tells that the joint has stood
    where it should for `dwell`.

    Source: laws.csp:56

    Parameters:
        gains: ServoGains, which may change.
        reach: double<rad>.
        rate: double<rad/s>.
        smoothing: time, in nanoseconds.
        dwell: time, in nanoseconds.
        margin: double<rad>.
        sample: the sample period in seconds.

    Ports:
        leftmax: in, double<rad>.
        rightmax: in, double<rad>.
        feedback: in, double<rad>.
        setpoint: in, double.
        control: out, double<V>.
        reference: out, double<rad>.
        stop: out, bool.
    """

    def __init__(
        self,
        name: str,
        *,
        gains: Parameter[ServoGains],
        reach: float,
        rate: float,
        smoothing: int,
        dwell: int,
        margin: float,
        sample: float,
        leftmax: In[float],
        rightmax: In[float],
        feedback: In[float],
        setpoint: In[float],
        control: Out[float],
        reference: Out[float],
        stop: Out[bool],
    ) -> None:
        super().__init__(name, source="laws.csp:56")
        self.leftmax = leftmax
        self.rightmax = rightmax
        self.feedback = feedback
        self.setpoint = setpoint
        self.control = control
        self.reference = reference
        self.stop = stop
        self.gains = gains
        self.reach = reach
        self.rate = rate
        self.smoothing = smoothing / s
        self.dwell = dwell / s
        self.margin = margin
        self.sample = sample
        self.reset()

    def reset(self) -> None:
        self.profile_moving = False
        self.profile_last = 0.0
        self.pid_e1 = 0.0
        self.pid_ud = 0.0
        self.pid_ui = 0.0
        self.arrived = 0.0

    async def run(self) -> None:
        leftmax, rightmax, feedback, setpoint = await read_all(
            self.leftmax, self.rightmax, self.feedback, self.setpoint
        )
        control, reference, stop = self.calculate(leftmax, rightmax, feedback, setpoint)
        await write_all((self.control, control), (self.reference, reference), (self.stop, stop))

    def calculate(
        self,
        leftmax: float,
        rightmax: float,
        feedback: float,
        setpoint: float,
    ) -> tuple[float, float, bool]:
        pid_ui = self.pid_ui
        gains = self.gains
        rate = self.rate
        margin = self.margin
        sample = self.sample
        pid_tauD = gains.value.tauD / s  # laws.csp:6
        pid_beta = gains.value.beta  # laws.csp:6
        pid_f = 1.0 / (sample + pid_tauD * pid_beta)  # laws.csp:14
        pid_kp = gains.value.kp  # laws.csp:6
        pid_tauI = gains.value.tauI / s  # laws.csp:6
        centre = (leftmax + rightmax) / 2.0  # laws.csp:71
        # laws.csp:72
        reference = finite(
            limit(centre + self.reach * setpoint, leftmax + margin, rightmax - margin)
        )
        profile_start = feedback  # laws.csp:73
        profile_from = self.profile_last if self.profile_moving else profile_start  # laws.csp:35
        profile_target = reference  # laws.csp:74
        # laws.csp:36
        profile_velocity = limit((profile_target - profile_from) / self.smoothing, -rate, rate)
        profile_angle = profile_from + sample * profile_velocity  # laws.csp:37
        pid_error = profile_angle - feedback  # laws.csp:75
        # laws.csp:15
        pid_d = pid_f * (
            pid_tauD * pid_beta * self.pid_ud
            + pid_tauD * pid_kp * (pid_error - self.pid_e1)
            + sample * pid_kp * pid_error
        )
        pid_i = pid_ui + sample * pid_d / pid_tauI  # laws.csp:16
        pid_sum = pid_i + pid_d  # laws.csp:17
        pid_output = limit(pid_sum, -0.99, 0.99)  # laws.csp:19
        assistance = gains.value.friction * limit(profile_velocity / 0.05, -1.0, 1.0)  # laws.csp:77
        control = finite(limit(supply * pid_output + assistance, -supply, supply))  # laws.csp:78
        # laws.csp:80
        standing = (
            self.arrived + sample if abs(reference - feedback) < gains.value.tolerance else 0.0
        )
        stop = standing >= self.dwell  # laws.csp:82
        profile_last_next = finite(profile_angle)  # laws.csp:39
        pid_e1_next = finite(pid_error)  # laws.csp:20
        pid_ud_next = finite(pid_d)  # laws.csp:21
        pid_ui_next = finite(pid_i if pid_sum == pid_output else pid_ui)  # laws.csp:22
        arrived_next = finite(standing)  # laws.csp:81
        self.profile_moving = True  # laws.csp:38
        self.profile_last = profile_last_next  # laws.csp:39
        self.pid_e1 = pid_e1_next  # laws.csp:20
        self.pid_ud = pid_ud_next  # laws.csp:21
        self.pid_ui = pid_ui_next  # laws.csp:22
        self.arrived = arrived_next  # laws.csp:81
        return control, reference, stop
