"""A native program that is continued piece by piece, while it is watched and its inputs are taken over: what
``LiveRun`` is for a program in Python, with the same trace.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from cspdiag.runtime.kernel.durations import END_OF_TIME
from cspdiag.simulate.native.values import encoded
from cspdiag.simulate.steered.process import SteeredProcess
from cspdiag.simulate.steered.recorder import SteeredRecorder

if TYPE_CHECKING:
    from cspdiag.network.ir.network import Environment, ExternalPort
    from cspdiag.runtime import Outcome
    from cspdiag.runtime.kernel.parameters import Change
    from cspdiag.simulate.native.run import NativeProgram
    from cspdiag.simulate.record.stored.inputs import RecordedInputs


class SteeredRun:
    """A native program from time 0 on, until ``until`` (nanoseconds): in virtual time, or in real time if it was built
    for that; then the clock runs from now on. ``inputs`` are those for which it was built.
    """

    def __init__(self, program: NativeProgram, until: int | None = None, inputs: RecordedInputs | None = None) -> None:
        self.network = program.network
        self.environment = program.environment
        self.recorder = SteeredRecorder(self.network)
        self._until = END_OF_TIME if until is None else min(until, END_OF_TIME)
        self._goal = 0
        """The instant up to which it was to continue last."""
        self._next: int | None = None
        self._coming = deque(() if inputs is None else sorted(inputs.parameter_changes, key=lambda change: change.time))
        self._free = free_inputs(self.network.external_ports, self.environment)
        self._process = SteeredProcess(program, self._until, self.recorder, inputs)

    @property
    def inputs(self) -> frozenset[str]:
        """See ``LiveRun``."""
        return frozenset(self._free)

    @property
    def now(self) -> int:
        """See ``LiveRun``."""
        return self._process.now if self.outcome is None else self.outcome.time

    @property
    def missed(self) -> dict[str, int]:
        """See ``LiveRun``."""
        top = f"{self.network.top}."
        return {name.removeprefix(top): count for name, count in self._process.missed.items() if count}

    @property
    def next_instant(self) -> int | None:
        """See ``LiveRun``."""
        return self._next

    @property
    def outcome(self) -> Outcome | None:
        """See ``LiveRun``."""
        return self._process.outcome

    @property
    def lateness(self) -> str:
        """How late a run in real time was that has ended, for people."""
        return self._process.lateness

    def take(self, name: str, value: Any) -> None:
        """See ``LiveRun``."""
        port = self._free[name]
        self._process.orders.take(self._number(port), encoded(port.type, value))

    def give_back(self, name: str) -> None:
        """See ``LiveRun``."""
        self._process.orders.give_back(self._number(self._free[name]))

    def _number(self, port: ExternalPort) -> int:
        return self.network.external_ports.index(port)

    def plan(self, change: Change) -> None:
        """See ``LiveRun``."""
        self._process.plan([change])

    def advance(self, until: int, wants_pause: Callable[[], bool]) -> bool:
        """See ``LiveRun``. False, too, as long as a step takes long that has begun before."""
        if self.outcome is not None:
            return True
        if not self._process.is_busy:
            self._goal = until
            self._plan_until(until)
            self._process.advance(min(until, self._until))
        return self._reached(wants_pause) and self._goal >= until

    def communicate(self, count: int, wants_pause: Callable[[], bool]) -> bool:
        """See ``LiveRun``."""
        if self.outcome is not None:
            return True
        if not self._process.is_busy:
            self._goal = self._until
            self._plan_until(self._until)
            self._process.step(self._until, count)
        return self._reached(wants_pause)

    def keep_pace(self, duration: int) -> None:
        """See ``LiveRun``."""
        if self.outcome is None:
            self._process.keep_pace(duration / 1e9)

    def _plan_until(self, until: int) -> None:
        """Plan the changes of a recording that are due."""
        while self._coming and self._coming[0].time <= until:
            self._process.plan([self._coming.popleft()])

    def _reached(self, wants_pause: Callable[[], bool]) -> bool:
        held = self._process.answer(wants_pause)
        self._next = held.next
        return held.reached

    def waiting(self, most: int) -> list[tuple[str, str, tuple[str, ...], str | None]]:
        """See ``LiveRun``."""
        if self.outcome is not None:
            return []
        found = self._process.waiting()
        return [(each.path, each.waits, each.channels, each.place or None) for each in found[:most]]

    def end(self) -> Outcome:
        """See ``LiveRun``."""
        self._process.end()
        self._process.close()
        assert self.outcome is not None
        return self.outcome


def free_inputs(ports: tuple[ExternalPort, ...], environment: Environment | None) -> dict[str, ExternalPort]:
    """The inputs that no device gives, which may be taken over, by name."""
    drivers = () if environment is None else environment.drivers
    taken = {external for driver in drivers for _, external in driver.connections}
    return {port.name: port for port in ports if port.direction == "in" and port.key not in taken}
