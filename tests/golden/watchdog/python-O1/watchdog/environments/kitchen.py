"""The environment Kitchen."""

from __future__ import annotations

from collections.abc import Mapping

from ..runtime import Driver, Signal, finite, floor, int64, ms
from ..types import Reading


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
        self._elapsed = 0
        self.chamber_temperature = 293.0
        self.chamber_shown = 293.0
        self.chamber_number = 0
        self._evaluate()

    def advance(self, now: int) -> None:
        """Integrate to `now` (in nanoseconds) with the inputs held, and evaluate the outputs."""
        time = self.now / 1_000_000_000
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
            self.chamber_number = (
                (n1 if (n1 := chamber_number + 1) <= 9223372036854775807 else int64(n1))
                if chamber_contact
                else chamber_number
            )
        elapsed = now - self.now
        if elapsed != self._elapsed:
            self._divide(elapsed)
        h = self._h
        half = self._half
        sixth = self._sixth
        # watchdog.csp:74
        k1_chamber_temperature = (chamber_heater - 0.5 * (chamber_temperature - 293.0)) / 20.0
        chamber_temperature_at = chamber_temperature + half * k1_chamber_temperature
        # watchdog.csp:74
        k2_chamber_temperature = (chamber_heater - 0.5 * (chamber_temperature_at - 293.0)) / 20.0
        chamber_temperature_at = chamber_temperature + half * k2_chamber_temperature
        # watchdog.csp:74
        k3_chamber_temperature = (chamber_heater - 0.5 * (chamber_temperature_at - 293.0)) / 20.0
        chamber_temperature_at = chamber_temperature + h * k3_chamber_temperature
        # watchdog.csp:74
        k4_chamber_temperature = (chamber_heater - 0.5 * (chamber_temperature_at - 293.0)) / 20.0
        chamber_temperature += sixth * (
            k1_chamber_temperature
            + 2.0 * k2_chamber_temperature
            + 2.0 * k3_chamber_temperature
            + k4_chamber_temperature
        )
        if chamber_temperature - chamber_temperature != 0.0:
            finite(chamber_temperature)  # watchdog.csp:74
        self.chamber_temperature = chamber_temperature
        self.now = now
        # watchdog.csp:77
        chamber_thermometer = Reading(number=self.chamber_number, temperature=self.chamber_shown)
        self.thermometer.value = chamber_thermometer  # watchdog.csp:83

    def _evaluate(self) -> None:
        # watchdog.csp:77
        chamber_thermometer = Reading(number=self.chamber_number, temperature=self.chamber_shown)
        self.thermometer.value = chamber_thermometer  # watchdog.csp:83

    def _divide(self, elapsed: int) -> None:
        """Remember the time between two instants, over which states are integrated in one step."""
        self._elapsed = elapsed
        self._h = elapsed / 1_000_000_000
        self._half = self._h / 2
        self._sixth = self._h / 6
