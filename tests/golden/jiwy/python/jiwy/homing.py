"""The process Homing."""

from __future__ import annotations

from .exceptions import ModeFailed
from .position_controller import PositionController
from .runtime import After, In, Out, Parameter, Process, Timeout, Variable, interrupt, ms, s
from .types import ServoGains


class Homing(Process):
    """Servo back to the centre; there, or where its patience ends, the motor is released.

    Source: jiwy.csp:76

    Parameters:
        T: time, in nanoseconds.
        gains: ServoGains, which may change.
        patience: time, in nanoseconds.

    Ports:
        leftmax: in, double<rad>.
        rightmax: in, double<rad>.
        feedback: in, double<rad> @ T.
        control: out, double<V> @ T.
    """

    def __init__(
        self,
        name: str,
        *,
        T: int,
        gains: Parameter[ServoGains],
        patience: int,
        leftmax: In[float],
        rightmax: In[float],
        feedback: In[float],
        control: Out[float],
    ) -> None:
        super().__init__(name, source="jiwy.csp:76")
        self.patience = patience
        self.control = control
        self.leftmax = leftmax.reader(self)
        self.rightmax = rightmax.reader(self)
        self.feedback = feedback.reader(self)
        self.zero = Variable[float](f"{name}.zero", 0.0)
        self.failed = Variable[bool](f"{name}.failed", False)
        self.stop = Variable[bool](f"{name}.stop")
        self.reference = Variable[float](f"{name}.reference")
        self.servo = PositionController(
            f"{name}.servo",
            gains=gains,
            reach=0.0,
            rate=6.0,
            smoothing=50 * ms,
            dwell=100 * ms,
            margin=0.05,
            sample=T / s,
            leftmax=self.leftmax,
            rightmax=self.rightmax,
            feedback=self.feedback,
            setpoint=self.zero,
            control=control,
            reference=self.reference,
            stop=self.stop,
        )

    async def run(self) -> None:
        try:
            await interrupt(self._repeat_servo, After(self.patience), self._continue)
        except Timeout:
            self.failed.value = True  # jiwy.csp:97
        await self.control.write(0.0)  # jiwy.csp:98
        if self.failed.value:
            raise ModeFailed  # jiwy.csp:99

    async def _repeat_servo(self) -> None:
        while True:
            await self.servo
            if self.stop.value:
                break

    async def _continue(self) -> None:
        pass
