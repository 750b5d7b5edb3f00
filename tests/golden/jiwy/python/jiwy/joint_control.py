"""The process JointControl."""

from __future__ import annotations

from .align import Align
from .homing import Homing
from .motion_control import MotionControl
from .runtime import In, Out, Parameter, Process, Variable, s
from .types import ServoGains


class JointControl(Process):
    """One joint through its four modes.

    Source: jiwy.csp:104

    Parameters:
        T: time, in nanoseconds.
        gains: ServoGains, which may change.
        reach: double<rad>.
        alignSpeed: double<rad/s>.
        alignKp: double<V*s/rad>.
        alignKi: double<V/rad>.

    Ports:
        feedback: in, double<rad> @ T.
        joystick_axis: in, double @ T.
        joystick_buttons: in, int.
        control: out, double<V> @ T.
    """

    def __init__(
        self,
        name: str,
        *,
        T: int,
        gains: Parameter[ServoGains],
        reach: float,
        alignSpeed: float,
        alignKp: float,
        alignKi: float,
        feedback: In[float],
        joystick_axis: In[float],
        joystick_buttons: In[int],
        control: Out[float],
    ) -> None:
        super().__init__(name, source="jiwy.csp:104")
        self.leftmax = Variable[float](f"{name}.leftmax")
        self.rightmax = Variable[float](f"{name}.rightmax")
        self.alignL = Align(
            f"{name}.alignL",
            T=T,
            speed=-alignSpeed,
            kp=alignKp,
            ki=alignKi,
            patience=10 * s,
            feedback=feedback,
            control=control,
            max_=self.leftmax,
        )
        self.alignR = Align(
            f"{name}.alignR",
            T=T,
            speed=alignSpeed,
            kp=alignKp,
            ki=alignKi,
            patience=10 * s,
            feedback=feedback,
            control=control,
            max_=self.rightmax,
        )
        self.motionControl = MotionControl(
            f"{name}.motionControl",
            T=T,
            gains=gains,
            reach=reach,
            leftmax=self.leftmax,
            rightmax=self.rightmax,
            feedback=feedback,
            joystick_axis=joystick_axis,
            joystick_buttons=joystick_buttons,
            control=control,
        )
        self.homing = Homing(
            f"{name}.homing",
            T=T,
            gains=gains,
            patience=3 * s,
            leftmax=self.leftmax,
            rightmax=self.rightmax,
            feedback=feedback,
            control=control,
        )

    async def run(self) -> None:
        await self.alignL
        await self.alignR
        await self.motionControl
        await self.homing
