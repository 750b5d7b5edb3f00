"""The process MotionControl."""

from __future__ import annotations

from .constants import stopButton
from .exceptions import ModeFailed
from .position_controller import PositionController
from .runtime import (
    Alternative,
    Discard,
    In,
    Input,
    Out,
    Parameter,
    Process,
    Ready,
    Timeout,
    Variable,
    ms,
    s,
)
from .types import ServoGains


class MotionControl(Process):
    """Servo that follows the joystick until the stop button is pressed, then releases the motor.

    Source: jiwy.csp:46

    Parameters:
        T: time, in nanoseconds.
        gains: ServoGains, which may change.
        reach: double<rad>.

    Ports:
        leftmax: in, double<rad>.
        rightmax: in, double<rad>.
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
        leftmax: In[float],
        rightmax: In[float],
        feedback: In[float],
        joystick_axis: In[float],
        joystick_buttons: In[int],
        control: Out[float],
    ) -> None:
        super().__init__(name, source="jiwy.csp:46")
        self.control = control
        self.joystick_buttons = joystick_buttons.reader(self)
        self.feedback = feedback.reader(self)
        self.leftmax = leftmax.reader(self)
        self.rightmax = rightmax.reader(self)
        self.joystick_axis = joystick_axis.reader(self)
        self.status = Variable[int](f"{name}.status", 0)
        self.failed = Variable[bool](f"{name}.failed", False)
        self.reference = Variable[float](f"{name}.reference")
        self.servo = PositionController(
            f"{name}.servo",
            gains=gains,
            reach=reach,
            rate=6.0,
            smoothing=50 * ms,
            dwell=100 * ms,
            margin=0.05,
            sample=T / s,
            leftmax=self.leftmax,
            rightmax=self.rightmax,
            feedback=self.feedback,
            setpoint=self.joystick_axis,
            control=control,
            reference=self.reference,
            stop=Discard(),
        )
        self.choice = Alternative(
            Input(self.joystick_buttons), Ready(self.feedback), prioritized=True
        )

    async def run(self) -> None:
        try:
            while True:
                match await self.choice.select():  # jiwy.csp:68
                    case 0:  # joystick_buttons ? status
                        self.status.value = self.choice.value
                    case 1:  # feedback
                        await self.servo
                if self.status.value == stopButton:
                    break
        except Timeout:
            self.failed.value = True  # jiwy.csp:69
        await self.control.write(0.0)  # jiwy.csp:70
        if self.failed.value:
            raise ModeFailed  # jiwy.csp:71
