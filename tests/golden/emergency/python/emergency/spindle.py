"""The process Spindle."""

from __future__ import annotations

from .runtime import In, Input, Out, Process, Variable, interrupt
from .spindle_controller import SpindleController
from .types import Button


class Spindle(Process):
    """Runs the spindle until the emergency button is pressed: whatever the law is doing is
    abandoned and the brake is applied. That it halted is announced when it stands still.

    Source: emergency.csp:17

    Ports:
        panel: in, Button.
        feedback: in, double<rad/s> @ T.
        control: out, double<V> @ T.
        brake: out, bool @ T.
        halted: out, bool.
    """

    def __init__(
        self,
        name: str,
        *,
        panel: In[Button],
        feedback: In[float],
        control: Out[float],
        brake: Out[bool],
        halted: Out[bool],
    ) -> None:
        super().__init__(name, source="emergency.csp:17")
        self.control = control
        self.brake = brake
        self.halted = halted
        self.panel = panel.reader(self)
        self.feedback = feedback.reader(self)
        self.button = Variable[Button](f"{name}.button", Button.none)
        self.speed = Variable[float](f"{name}.speed")
        self.law = SpindleController(
            f"{name}.law", speed=200.0, feedback=self.feedback, control=control
        )
        self.interruption = Input(self.panel)

    async def run(self) -> None:
        while True:
            self.button.value = await self.panel.read()  # emergency.csp:34
            if self.button.value == Button.start:
                break
        await self.brake.write(False)  # emergency.csp:35
        await interrupt(self._repeat_law, self.interruption, self._interrupted)  # emergency.csp:36
        while True:
            self.speed.value = await self.feedback.read()  # emergency.csp:37
            if self.speed.value < 1.0:
                break
        await self.halted.write(True)  # emergency.csp:38

    async def _repeat_law(self) -> None:
        while True:
            await self.law

    async def _interrupted(self) -> None:
        self.button.value = self.interruption.value
        await self.control.write(0.0)  # emergency.csp:36
        await self.brake.write(True)  # emergency.csp:36
