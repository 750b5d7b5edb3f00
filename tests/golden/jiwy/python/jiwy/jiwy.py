"""The process Jiwy."""

from __future__ import annotations

from .constants import Tsh, Tsv
from .joint_control import JointControl
from .runtime import In, Out, Parameter, Process, parallel
from .types import ServoGains


class Jiwy(Process):
    """The pan-and-tilt end-effector: both joints at the same time, each at its own sample period.

    Source: jiwy.csp:134

    Parameters:
        panGains: ServoGains, which may change. Servo of the horizontal joint; the first four are published.
        tiltGains: ServoGains, which may change. Servo of the vertical joint.

    Ports:
        joystick_horizontal: in, double @ Tsh.
        joystick_vertical: in, double @ Tsv.
        joystick_buttons: in, int.
        feedback_horizontal: in, double<rad> @ Tsh.
        feedback_vertical: in, double<rad> @ Tsv.
        control_horizontal: out, double<V> @ Tsh.
        control_vertical: out, double<V> @ Tsv.
    """

    def __init__(
        self,
        name: str,
        *,
        panGains: Parameter[ServoGains],
        tiltGains: Parameter[ServoGains],
        joystick_horizontal: In[float],
        joystick_vertical: In[float],
        joystick_buttons: In[int],
        feedback_horizontal: In[float],
        feedback_vertical: In[float],
        control_horizontal: Out[float],
        control_vertical: Out[float],
    ) -> None:
        super().__init__(name, source="jiwy.csp:134")
        self.horizontal = JointControl(
            f"{name}.horizontal",
            T=Tsh,
            gains=panGains,
            reach=1.25,
            alignSpeed=1.0,
            alignKp=0.3,
            alignKi=2.2,
            feedback=feedback_horizontal,
            joystick_axis=joystick_horizontal,
            joystick_buttons=joystick_buttons,
            control=control_horizontal,
        )
        self.vertical = JointControl(
            f"{name}.vertical",
            T=Tsv,
            gains=tiltGains,
            reach=1.25,
            alignSpeed=1.0,
            alignKp=0.11,
            alignKi=2.2,
            feedback=feedback_vertical,
            joystick_axis=joystick_vertical,
            joystick_buttons=joystick_buttons,
            control=control_vertical,
        )

    async def run(self) -> None:
        await parallel(self.horizontal, self.vertical)
