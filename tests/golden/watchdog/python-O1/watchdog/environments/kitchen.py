"""The environment Kitchen."""

from __future__ import annotations

from collections.abc import Generator, Mapping

from ..runtime import Driver, Signal, finite, floor, int64, ms, rk4_matrices
from ..types import Reading

# dx/dt = chamber_a x + r, where r is held between two instants, x = (chamber_temperature)
chamber_a = ((-0.025,),)


class Kitchen:
    """The environment Kitchen.

    Source: watchdog.csp:80
    """

    step = 100 * ms
    on_miss = "timeout"

    def __init__(self) -> None:
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
        self.chamber_shown = 293.0
        self.chamber_number = 0
        self._run = self._running()
        next(self._run)

    def advance(self, now: int) -> None:
        """Integrate to `now` (in nanoseconds) with the inputs held, and evaluate the outputs."""
        self._run.send(now)

    def _running(self) -> Generator[None, int, None]:
        """Evaluate the outputs, wait for the next instant, integrate to it, and again."""
        thermometer_signal = self.thermometer
        heater_signal = self.heater
        chamber_temperature = 293.0
        now = 0
        elapsed = 0
        while True:
            # watchdog.csp:77
            chamber_thermometer = Reading(
                number=self.chamber_number, temperature=self.chamber_shown
            )
            thermometer_signal.value = chamber_thermometer  # watchdog.csp:83
            before = now
            now = yield
            time = before / 1_000_000_000
            heater = heater_signal.value
            chamber_shown = self.chamber_shown
            chamber_number = self.chamber_number
            chamber_round = floor(time / 10.0)  # watchdog.csp:71
            # watchdog.csp:72
            chamber_contact = time - 10.0 * chamber_round < 9.8 - 0.2 * chamber_round
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
            chamber_temperature_held = (chamber_heater - -146.5) / 20.0  # watchdog.csp:74
            if now - before != elapsed:
                elapsed = now - before
                h = elapsed / 1_000_000_000
                chamber_m, chamber_n = rk4_matrices(chamber_a, h)
                chamber_m00 = chamber_m[0][0]
                chamber_n00 = chamber_n[0][0]
            # A step of RK4 over h is x = M x + N r.
            chamber_temperature = (
                chamber_m00 * chamber_temperature + chamber_n00 * chamber_temperature_held
            )
            if chamber_temperature - chamber_temperature != 0.0:
                finite(chamber_temperature)  # watchdog.csp:74
