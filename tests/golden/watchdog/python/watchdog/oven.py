"""The process Oven."""

from __future__ import annotations

from contextlib import suppress

from .exceptions import GivenUp, SensorLost
from .heating import Heating
from .runtime import In, Out, Process, Variable, int64, ms
from .types import Reading


class Oven(Process):
    """Switches the heater off when the thermometer is lost, and tries again; the third time it
    gives up.

    Source: watchdog.csp:32

    Ports:
        thermometer: in, Reading.
        heater: out, double<W>.
        losses: out, int.
    """

    def __init__(
        self,
        name: str,
        *,
        thermometer: In[Reading],
        heater: Out[float],
        losses: Out[int],
    ) -> None:
        super().__init__(name, source="watchdog.csp:32")
        self.heater = heater
        self.losses = losses
        self.lost = Variable[int](f"{name}.lost", 0)
        self.heating = Heating(
            f"{name}.heating",
            patience=550 * ms,
            wanted=340.0,
            thermometer=thermometer,
            heater=heater,
        )

    async def run(self) -> None:
        with suppress(GivenUp):
            while True:
                try:
                    await self.heating
                except SensorLost:
                    await self.heater.write(0.0)  # watchdog.csp:50
                    self.lost.value = int64(self.lost.value + 1)  # watchdog.csp:51
                    await self.losses.write(self.lost.value)  # watchdog.csp:52
                    if self.lost.value == 3:
                        raise GivenUp  # watchdog.csp:53
