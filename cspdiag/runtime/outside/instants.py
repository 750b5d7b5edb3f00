"""The instants at which a program meets its environment, and what happens at one, in order.

First the environment advances; then events are offered and samples taken, in the order of the ports; then latched
outputs are handed over; then timers fall due.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import gcd, lcm
from typing import Any, Protocol, TypeAlias

from ..kernel.durations import ms
from ..kernel.exceptions import EnvironmentFailure, fault_of
from ..kernel.places import raised_by_program, statement_of
from ..kernel.stopping import stopping
from .event_inputs import EventInput
from .external import EventOutput, Port, SampledOutput
from .sampled_inputs import SampledEnd, SampledInput
from .ticks import Ticks

Plan: TypeAlias = tuple[Callable[[], None], ...]

_REMEMBERED = 1 << 14
"""How many phases are remembered: all of any usual hyperperiod, and a bounded number if the common multiple of the
periods is huge.
"""


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
    except BaseException as error:
        if stopping.ends_run(error):
            raise
        raise failure_of(type(environment).__name__, error) from error


def failure_of(environment: str, error: BaseException) -> EnvironmentFailure:
    """The exception that ends the run; an error of arithmetic in an equation is a fault."""
    place = statement_of(error)
    if isinstance(error, ArithmeticError) and raised_by_program(error):
        return EnvironmentFailure(environment, fault_of(error, None), place)
    return EnvironmentFailure(environment, error, place)


class Instants:
    """Ticks of all periods and the grid of the environment."""

    def __init__(self, ports: Sequence[Port], environment: Environment | None) -> None:
        self._ports = tuple(ports)
        self._advance = None if environment is None else environment.advance
        self._environment = type(environment).__name__
        self._sampled = sorted({port.ticks for port in ports if isinstance(port, SampledInput | SampledOutput)})
        self.periods = tuple(dict.fromkeys(ticks.period for ticks in self._sampled))
        self._grid = self._grid_of(environment)
        self._cycles = sorted({*self._sampled, *([Ticks(self._grid)] if self._grid else [])})
        self._hyperperiod = lcm(*(ticks.period for ticks in self._cycles))
        self._phases: dict[int, tuple[int, Plan | None]] = {}
        """By the phase of the hyperperiod: the time to the next instant, and what happens at this one; None if nothing
        does.
        """
        self._likely_port: Port | None = None
        """The port that was last found to be able to make a process ready."""
        self.awaited_end: SampledEnd[Any] | None = None
        """Where a process was last found to wait for a sample that will arrive; it often does so again."""

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
        return instant + self._phase(instant % self._hyperperiod)[0]

    def _phase(self, phase: int) -> tuple[int, Plan | None]:
        found = self._phases.get(phase)
        if found is None:
            found = min([ticks.after(phase) for ticks in self._cycles]) - phase, self._plan(phase)
            if len(self._phases) < _REMEMBERED:
                self._phases[phase] = found
        return found

    def periods_at(self, instant: int) -> list[int]:
        """The sample periods whose tick ``instant`` is."""
        return list(dict.fromkeys(ticks.period for ticks in self._sampled if ticks.at(instant)))

    def meet(self, instant: int, present: int = 0) -> int | None:
        """Does what happens at ``instant`` before any process runs, except timers. Returns the next instant after it.

        If it is already ``present``, only the last one of several ticks that have passed calls the driver.
        """
        if not self._cycles:
            return None
        phase = instant % self._hyperperiod
        distance, plan = self._phases.get(phase) or self._phase(phase)
        if present and plan is not None and present - instant >= self._cycles[0].period:
            plan = self._plan(phase, present - instant)
        if plan is not None:
            if self._advance is not None:
                try:
                    self._advance(instant)
                except BaseException as error:
                    if stopping.ends_run(error):
                        raise
                    raise failure_of(self._environment, error) from error
            for action in plan:
                action()
        return instant + distance

    def _plan(self, phase: int, late: int = 0) -> Plan | None:
        if not any(ticks.at(phase) for ticks in self._cycles):
            return None
        inputs: list[Callable[[], None]] = []
        outputs: list[Callable[[], None]] = []
        for port in self._ports:
            match port:
                case SampledInput():
                    if port.ticks.at(phase):
                        inputs.append(port.skip if port.ticks.period <= late else port.at_tick())
                case EventInput():
                    if port.polled and phase % self._grid == 0 and self._grid > late:
                        inputs.append(port.at_grid())
                case SampledOutput():
                    if port.ticks.at(phase) and not port.immediate:
                        outputs.append(port.at_tick())
                case EventOutput():
                    pass
        return (*inputs, *outputs)

    def port_can_have_effect(self) -> bool:
        """Whether anything at a later instant, except timers, can make a process ready or hand over a value."""
        if self._likely_port is not None and self._likely_port.can_have_effect:
            return True
        for port in self._ports:
            if port.can_have_effect:
                self._likely_port = port
                self.awaited_end = port.awaited_end if isinstance(port, SampledInput) else None
                return True
        return False
