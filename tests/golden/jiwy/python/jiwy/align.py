"""The process Align."""

from __future__ import annotations

from .exceptions import ModeFailed
from .runtime import After, In, Out, Process, Timeout, Variable, interrupt, ms, s
from .velocity_controller import VelocityController


class Align(Process):
    """Turns one joint at constant speed until it meets its end stop, and remembers where that was.

    Source: jiwy.csp:23

    Parameters:
        T: time, in nanoseconds.
        speed: double<rad/s>.
        kp: double<V*s/rad>.
        ki: double<V/rad>.
        patience: time, in nanoseconds.

    Ports:
        feedback: in, double<rad> @ T.
        control: out, double<V> @ T.
        max: out, double<rad>.
    """

    def __init__(
        self,
        name: str,
        *,
        T: int,
        speed: float,
        kp: float,
        ki: float,
        patience: int,
        feedback: In[float],
        control: Out[float],
        max_: Out[float],
    ) -> None:
        super().__init__(name, source="jiwy.csp:23")
        self.patience = patience
        self.control = control
        self.feedback = feedback.reader(self)
        self.failed = Variable[bool](f"{name}.failed", False)
        self.stop = Variable[bool](f"{name}.stop")
        self.velocity = VelocityController(
            f"{name}.velocity",
            speed=speed,
            kp=kp,
            ki=ki,
            pressure=1.5,
            effort=0.9,
            filter_=20 * ms,
            dwell=100 * ms,
            sample=T / s,
            feedback=self.feedback,
            control=control,
            max_=max_,
            stop=self.stop,
        )

    async def run(self) -> None:
        try:
            await interrupt(self._repeat_velocity, After(self.patience), self._interrupted)
        except Timeout:
            self.failed.value = True  # jiwy.csp:39
        await self.control.write(0.0)  # jiwy.csp:40
        if self.failed.value:
            raise ModeFailed  # jiwy.csp:41

    async def _repeat_velocity(self) -> None:
        while True:
            await self.velocity
            if self.stop.value:
                break

    async def _interrupted(self) -> None:
        self.failed.value = True  # jiwy.csp:39
