"""The instants at which a program meets its environment, and what happens at one, in order.

The environment advances; events are offered and samples taken, in the order of the ports; latched outputs are handed over; then timers fall due.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import gcd, lcm
from typing import Any, Protocol, TypeAlias, TypeVar

from .durations import ms
from .exceptions import EnvironmentFailure
from .external import EventOutput, Port, SampledOutput
from .inputs import EventInput, SampledInput
from .places import statement_of
from .scheduler import scheduler

Plan: TypeAlias = tuple[Callable[[], None], ...]
V = TypeVar("V")

_NOT_PLANNED: Plan = (lambda: None,)
_REMEMBERED = 1 << 14
"""So many phases are remembered: all of any usual hyperperiod, and a bounded number of periods that have nearly no common multiple."""


def _remember(phases: dict[int, V], phase: int, value: V) -> None:
    if len(phases) < _REMEMBERED:
        phases[phase] = value


class Environment(Protocol):
    """A plant and its operator, simulated."""

    step: int
    """The grid in nanoseconds on which it is evaluated, besides the ticks."""
    drivers: Mapping[str, Any]
    """By port of the program."""

    def start(self) -> None:
        """Evaluates the outputs at time 0."""
        ...

    def advance(self, now: int) -> None:
        """Advances to ``now`` with the inputs held, and evaluates the outputs."""
        ...


def start(environment: Environment) -> None:
    """Evaluates an environment at time 0. Raises EnvironmentFailure with what it raises."""
    try:
        environment.start()
    except Exception as error:
        raise EnvironmentFailure(type(environment).__name__, error, statement_of(error)) from error


class Instants:
    """Ticks of all periods and the grid of the environment."""

    def __init__(self, ports: Sequence[Port], environment: Environment | None) -> None:
        self._ports = tuple(ports)
        self._advance = None if environment is None else environment.advance
        self._environment = type(environment).__name__
        periods = {port.period for port in ports if isinstance(port, SampledInput | SampledOutput)}
        self.periods: tuple[int, ...] = tuple(sorted(periods))
        self._grid = self._grid_of(environment)
        self._cycles = tuple(sorted(periods | ({self._grid} if self._grid else set())))
        self._hyperperiod = lcm(*self._cycles)
        self._distances: dict[int, int] = {}
        """From an instant to the next one, by the phase of the hyperperiod."""
        self._plans: dict[int, Plan | None] = {}
        """What happens at an instant, by the phase of the hyperperiod; None where nothing does."""
        self._hopeful: Port | None = None
        """The port that could make a process ready when it was asked last."""

    def _grid_of(self, environment: Environment | None) -> int:
        if environment is not None:
            return environment.step
        if any(isinstance(port, EventInput) and port.polled for port in self._ports):
            return gcd(*self.periods) if self.periods else ms
        return 0

    def after(self, instant: int) -> int | None:
        """The next instant after ``instant``."""
        if not self._cycles:
            return None
        phase = instant % self._hyperperiod
        distance = self._distances.get(phase)
        if distance is None:
            distance = min([cycle - phase % cycle for cycle in self._cycles])
            _remember(self._distances, phase, distance)
        return instant + distance

    def periods_at(self, instant: int) -> list[int]:
        """The sample periods whose tick ``instant`` is."""
        return [period for period in self.periods if instant % period == 0]

    def meet(self, instant: int) -> None:
        """What happens at ``instant`` before any process runs, but for the timers."""
        phase = instant % self._hyperperiod
        plan = self._plans.get(phase, _NOT_PLANNED)
        if plan is _NOT_PLANNED:
            plan = self._plan(phase)
            _remember(self._plans, phase, plan)
        if plan is None:
            return
        if self._advance is not None:
            try:
                self._advance(instant)
            except Exception as error:
                raise EnvironmentFailure(self._environment, error, statement_of(error)) from error
        for action in plan:
            action()

    def _plan(self, phase: int) -> Plan | None:
        if all(phase % cycle for cycle in self._cycles):
            return None
        inputs: list[Callable[[], None]] = []
        outputs: list[Callable[[], None]] = []
        for port in self._ports:
            match port:
                case SampledInput():
                    if phase % port.period == 0:
                        inputs.append(port.at_tick())
                case EventInput():
                    if port.polled and phase % self._grid == 0:
                        inputs.append(port.at_grid())
                case SampledOutput():
                    if phase % port.period == 0 and not port.immediate:
                        outputs.append(port.at_tick())
                case EventOutput():
                    pass
        return (*inputs, *outputs)

    def can_come(self) -> bool:
        """Whether anything at a later instant can make a process ready or hand over a value."""
        if scheduler.timers.next_instant() is not None:
            return True
        if self._hopeful is not None and self._hopeful.can_come:
            return True
        for port in self._ports:
            if port.can_come:
                self._hopeful = port
                return True
        return False
