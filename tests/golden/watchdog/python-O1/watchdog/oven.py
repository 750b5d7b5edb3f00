"""The process Oven."""

from __future__ import annotations

from .exceptions import GivenUp, SensorLost
from .runtime import (
    After,
    Alternative,
    In,
    Inlined,
    Input,
    Out,
    Routine,
    Steps,
    Task,
    finite,
    int64,
)
from .types import Reading


class Oven(Routine):
    """Switches the heater off when the thermometer is lost, and tries again; the third time it
    gives up.

    Source: watchdog.csp:32

    Ports:
        thermometer: in, Reading.
        heater: out, double<W>.
        losses: out, int.
    """

    __slots__ = ("heater", "heating_choice", "heating_process", "losses", "thermometer")

    kind = "Oven"
    source = "watchdog.csp:32"

    def __init__(
        self,
        name: str,
        *,
        thermometer: In[Reading],
        heater: Out[float],
        losses: Out[int],
    ) -> None:
        super().__init__(name)
        self.heater = heater
        self.losses = losses
        self.heating_process = Inlined(f"{name}.heating", "Heating", source="watchdog.csp:48")
        self.thermometer = thermometer.reader(self)
        self.heating_choice = Alternative(Input(self.thermometer), After(550_000_000))

    def steps(self, me: Task) -> Steps:
        scheduler = me.scheduler
        heating_process = self.heating_process
        heating_choice = self.heating_choice
        thermometer = self.thermometer
        heater = self.heater
        losses = self.losses
        heating_choice_guards = heating_choice.selector
        heating_latest: Reading
        lost: int = 0
        heating_choice_after = 0
        self.start(me)
        try:
            try:
                while True:
                    try:
                        # watchdog.csp:48  heating
                        heating_process.start(me)
                        try:
                            while True:
                                # watchdog.csp:24  thermometer ? latest -> heater ! limit(5<W/K>...
                                ready = heating_choice_guards.ready
                                if not ready:
                                    scheduler.current = me
                                    ready = yield from heating_choice.wait(-1)
                                first = ready >> heating_choice_after
                                if not first:
                                    first = ready
                                    heating_choice_after = 0
                                k = heating_choice_after + (first & -first).bit_length() - 1
                                heating_choice_after = k + 1
                                if k == 0:  # thermometer ? latest
                                    scheduler.current = me
                                    heating_latest = thermometer.take()
                                    # watchdog.csp:24  heater ! limit(5<W/K> * (wanted - latest.t...
                                    value = (
                                        x2
                                        if (
                                            x2 := 0.0
                                            if (x1 := 5.0 * (340.0 - heating_latest.temperature))
                                            < 0.0
                                            else 100.0
                                            if x1 > 100.0
                                            else x1
                                        )
                                        - x2
                                        == 0.0
                                        else finite(x2)
                                    )
                                    heater.offer(me, value)
                                else:  # after patience
                                    raise SensorLost  # watchdog.csp:26
                        except BaseException as error:
                            heating_process.fail(me, error)
                            raise
                    except SensorLost:
                        # watchdog.csp:50  heater ! 0<W>
                        heater.offer(me, 0.0)
                        # watchdog.csp:51
                        lost = n1 if (n1 := lost + 1) <= 9223372036854775807 else int64(n1)
                        # watchdog.csp:52  losses ! lost
                        losses.offer(me, lost)
                        if lost == 3:
                            raise GivenUp  # watchdog.csp:53
            except GivenUp:
                pass
        except BaseException as error:
            self.fail(me, error)
            raise
        self.end(me)
