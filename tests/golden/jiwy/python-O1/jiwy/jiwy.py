"""The process Jiwy."""

from __future__ import annotations

from .joint_control import JointControl
from .runtime import In, Parameter, Routine, SampledInput, SampledOutput, Steps, Task, parallel
from .types import ServoGains


class Jiwy(Routine):
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

    __slots__ = ("horizontal", "vertical")

    kind = "Jiwy"
    source = "jiwy.csp:134"

    def __init__(
        self,
        name: str,
        *,
        panGains: Parameter[ServoGains],
        tiltGains: Parameter[ServoGains],
        joystick_horizontal: SampledInput[float],
        joystick_vertical: SampledInput[float],
        joystick_buttons: In[int],
        feedback_horizontal: SampledInput[float],
        feedback_vertical: SampledInput[float],
        control_horizontal: SampledOutput[float],
        control_vertical: SampledOutput[float],
    ) -> None:
        super().__init__(name)
        self.horizontal = JointControl(
            f"{name}.horizontal",
            T=2_000_000,
            gains=panGains,
            alignKp=0.3,
            feedback=feedback_horizontal,
            joystick_axis=joystick_horizontal,
            joystick_buttons=joystick_buttons,
            control=control_horizontal,
        )
        self.vertical = JointControl(
            f"{name}.vertical",
            T=1_000_000,
            gains=tiltGains,
            alignKp=0.11,
            feedback=feedback_vertical,
            joystick_axis=joystick_vertical,
            joystick_buttons=joystick_buttons,
            control=control_vertical,
        )

    def steps(self, me: Task) -> Steps:
        scheduler = me.scheduler
        self.start(me)
        try:
            # jiwy.csp:157  horizontal || vertical
            scheduler.current = me
            yield from parallel(self.horizontal, self.vertical)
        except BaseException as error:
            self.fail(me, error)
            raise
        self.end(me)
