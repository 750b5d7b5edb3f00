"""The process Heating."""

from __future__ import annotations

from .exceptions import SensorLost
from .runtime import After, Alternative, In, Input, Out, Process, Variable, finite, limit
from .types import Reading


class Heating(Process):
    """Heats towards the wanted temperature as long as the thermometer reports. It is not sampled:
    it sends when it has something new to say.

    Source: watchdog.csp:14

    Parameters:
        patience: time, in nanoseconds.
        wanted: double<K>.

    Ports:
        thermometer: in, Reading.
        heater: out, double<W>.
    """

    def __init__(
        self,
        name: str,
        *,
        patience: int,
        wanted: float,
        thermometer: In[Reading],
        heater: Out[float],
    ) -> None:
        super().__init__(name, source="watchdog.csp:14")
        self.patience = patience
        self.wanted = wanted
        self.heater = heater
        self.thermometer = thermometer.reader(self)
        self.latest = Variable[Reading](f"{name}.latest")
        self.choice = Alternative(Input(self.thermometer), After(patience))

    async def run(self) -> None:
        while True:
            match await self.choice.select():  # watchdog.csp:24
                case 0:  # thermometer ? latest
                    self.latest.value = self.choice.value
                    # watchdog.csp:24
                    await self.heater.write(
                        finite(
                            limit(5.0 * (self.wanted - self.latest.value.temperature), 0.0, 100.0)
                        ),
                    )
                case 1:  # after patience
                    raise SensorLost  # watchdog.csp:26
