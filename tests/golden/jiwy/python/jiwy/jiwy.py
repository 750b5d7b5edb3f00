"""The process Jiwy."""

from __future__ import annotations

from .constants import Tsh, Tsv
from .joint_control import JointControl
from .runtime import In, Out, Process, ms, parallel, s


class Jiwy(Process):
    """The pan-and-tilt end-effector: both joints at the same time, each at its own sample period.

    Source: jiwy.csp:140

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
        joystick_horizontal: In[float],
        joystick_vertical: In[float],
        joystick_buttons: In[int],
        feedback_horizontal: In[float],
        feedback_vertical: In[float],
        control_horizontal: Out[float],
        control_vertical: Out[float],
    ) -> None:
        super().__init__(name, source="jiwy.csp:140")
        self.horizontal = JointControl(
            f"{name}.horizontal",
            T=Tsh,
            kp=2.6,
            tauD=50 * ms,
            beta=0.17,
            tauI=9 * s,
            friction=0.25,
            tolerance=4e-3,
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
            kp=1.6,
            tauD=50 * ms,
            beta=0.001,
            tauI=10500 * ms,
            friction=0.165,
            tolerance=15e-3,
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
