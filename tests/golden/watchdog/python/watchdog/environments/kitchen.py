"""The environment Kitchen."""

from __future__ import annotations

from collections.abc import Mapping

from ..runtime import Driver, Signal, finite, floor, int64, ms, rk4_matrices, s
from ..types import Reading

chamber_room = 293.0  # watchdog.csp:63
chamber_leak = 0.5  # watchdog.csp:63
chamber_capacity = 20.0  # watchdog.csp:63
# dx/dt = chamber_a x + r, where r is held between two instants, x = (chamber_temperature)
chamber_a = ((-chamber_leak / chamber_capacity,),)


class Kitchen:
    """The environment Kitchen.

    Source: watchdog.csp:80
    """

    step = 100 * ms
    on_miss = "timeout"

    def __init__(self) -> None:
        self.now = 0
        self.thermometer = Signal[Reading](Reading(number=0, temperature=0.0))
        self.heater = Signal[float](0.0)
        self.losses = Signal[int](0)
        self.drivers: Mapping[str, Driver] = {
            "thermometer": self.thermometer,
            "heater": self.heater,
            "losses": self.losses,
        }

    def start(self) -> None:
        """Go to time 0 and evaluate the outputs."""
        self.now = 0
        self.chamber_temperature = chamber_room
        self.chamber_shown = chamber_room
        self.chamber_number = 0
        self._evaluate()

    def advance(self, now: int) -> None:
        """Integrate to `now` (in nanoseconds) with the inputs held, and evaluate the outputs."""
        time = self.now / s
        heater = self.heater.value
        chamber_shown = self.chamber_shown
        chamber_number = self.chamber_number
        chamber_temperature = self.chamber_temperature
        chamber_round = floor(time / 10.0)  # watchdog.csp:71
        chamber_contact = time - 10.0 * chamber_round < 9.8 - 0.2 * chamber_round  # watchdog.csp:72
        chamber_heater = heater  # watchdog.csp:84
        if now % self.step == 0:
            # watchdog.csp:75
            self.chamber_shown = chamber_temperature if chamber_contact else chamber_shown
            # watchdog.csp:76
            self.chamber_number = int64(chamber_number + 1) if chamber_contact else chamber_number
        # watchdog.csp:74
        chamber_temperature_held = (
            chamber_heater - chamber_leak * -chamber_room
        ) / chamber_capacity
        h = (now - self.now) / s
        # A step of RK4 over h is x = M x + N r.
        chamber_m, chamber_n = rk4_matrices(chamber_a, h)
        chamber_temperature = (
            chamber_m[0][0] * chamber_temperature + chamber_n[0][0] * chamber_temperature_held
        )
        self.chamber_temperature = finite(chamber_temperature)  # watchdog.csp:74
        self.now = now
        self._evaluate()

    def _evaluate(self) -> None:
        # watchdog.csp:77
        chamber_thermometer = Reading(number=self.chamber_number, temperature=self.chamber_shown)
        self.thermometer.value = chamber_thermometer  # watchdog.csp:83
