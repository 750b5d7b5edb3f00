"""The instants at which a program meets its environment, and what happens at one, in order.

First the environment advances; then events are offered and samples taken, in the order of the ports; then latched
outputs are handed over; then timers fall due.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby
from math import gcd, lcm
from typing import Any, NoReturn, Protocol, TypeAlias

from ..channels.selector import raise_bits
from ..kernel.durations import ms
from ..kernel.exceptions import EnvironmentFailure, fault_of
from ..kernel.places import line_by_hand, raised_by_program, statement_of
from ..kernel.scheduler import Scheduler, Task, present
from ..kernel.stopping import stopping
from .drivers import Signal
from .event_inputs import EventInput
from .external import EventOutput, Port, SampledOutput
from .sampled_inputs import SampledEnd, SampledInput
from .ticks import Ticks

Actions: TypeAlias = tuple[Callable[[], None], ...]
_Passing: TypeAlias = "SampledInput[Any] | EventInput[Any] | SampledOutput[Any]"
"""A port at which something happens at instants."""

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


def _nothing(now: int) -> None:
    """There is no environment to advance."""


def failure_of(environment: str, error: BaseException) -> EnvironmentFailure:
    """The exception that ends the run; an error of arithmetic in an equation is a fault."""
    place = statement_of(error)
    if isinstance(error, ArithmeticError) and raised_by_program(error):
        return EnvironmentFailure(environment, fault_of(error, None), place)
    return EnvironmentFailure(environment, error, place, line_by_hand(error))


def _in_turn(ports: Sequence[_Passing], late: int) -> Iterator[Callable[[], None]]:
    """What happens at ports, in order: inputs take values, and outputs hand them over. A sample whose tick has passed
    together with the next one, as it is ``late``, is missed.
    """

    def is_simulated(port: _Passing) -> bool:
        return type(port.line) is Signal and not (isinstance(port, SampledInput) and port.ticks.period <= late)

    for simulated, group in groupby(ports, is_simulated):
        if simulated:
            yield _in_one_step(list(group))
        else:
            yield from [_alone(port, late) for port in group]


def _alone(port: _Passing, late: int) -> Callable[[], None]:
    match port:
        case SampledInput():
            return port.skip if port.ticks.period <= late else port.sample
        case EventInput():
            return port.poll
        case SampledOutput():
            return port.tick


def _in_one_step(ports: Sequence[_Passing]) -> Callable[[], None]:
    """What happens at ports whose drivers are signals of an environment, inputs first: the same as one by one, in half
    the time. The end of a sampled input with only one is served in place.
    """
    scheduler = present()
    observe, log = scheduler.observe, scheduler.sample_log
    sampled = [port for port in ports if isinstance(port, SampledInput)]
    inputs: list[tuple[Any, Any, bool]] = [
        (port, port.line, isinstance(port, SampledInput)) for port in ports if not isinstance(port, SampledOutput)
    ]
    outputs = [(port, port.line, *scheduler.port_log(port.name)) for port in ports if isinstance(port, SampledOutput)]
    noted = [(port.line, *scheduler.port_log(port.name)) for port in sampled if port.name in scheduler.port_logs]
    notes_outputs = bool(scheduler.port_logs)

    def pass_on() -> None:
        if noted:
            for signal, note_time, note_value in noted:
                note_time(scheduler.now)
                note_value(signal.value)
        elif log is not None:
            log.extend(entry for port in sampled for entry in (scheduler.now, port.name, port.line.value))
        enqueue = scheduler.enqueue
        for port, signal, is_sampled in inputs:
            value = signal.value
            if not is_sampled:
                if value != port.last:
                    port.last = value
                    port.occur(value)
                continue
            port.latest = value
            end = port.only
            if end is not None and not end.fresh:
                end.value = value
                end.fresh = True
                waiter = end.waiter
                if waiter is not None:
                    end.waiter = None
                    enqueue(waiter.entry)
                if end.inputs:
                    raise_bits(end.inputs)
            elif port.listening is None or port.listening:
                port.hand_out(value)
        for output, signal, note_time, note_value in outputs:
            if output.written:
                output.written = False
                signal.value = value = output.latched
                if notes_outputs:
                    note_time(scheduler.now)
                    note_value(value)
                elif observe is not None:
                    observe(output.name, value, output.writer, None)

    return pass_on


class _Phase:
    """An instant of the hyperperiod.

    ``distance`` is the time to the next one, which is ``following`` if that is known. ``actions`` are what happens
    after the environment has advanced; None: it is no tick and not on the grid.
    """

    __slots__ = ("actions", "distance", "following")

    def __init__(self, distance: int, actions: Actions | None) -> None:
        self.distance = distance
        self.actions = actions
        self.following: _Phase | None = None


class Instants:
    """Ticks of all periods and the grid of the environment; at the ticks of its ``own`` ports, by default all, values
    are taken and handed over.
    """

    def __init__(
        self, ports: Sequence[Port], environment: Environment | None, own: Sequence[Port] | None = None
    ) -> None:
        self._ports = tuple(ports if own is None else own)
        self._environment = environment
        self._advance: Callable[[int], object] = _nothing if environment is None else environment.advance
        self._sampled = sorted(
            {
                port.ticks
                for port in ports
                if isinstance(port, SampledInput) or (isinstance(port, SampledOutput) and port.has_ticks)
            }
        )
        self.periods = tuple(dict.fromkeys(ticks.period for ticks in self._sampled))
        self._grid = self._grid_of(environment)
        self._cycles = sorted({*self._sampled, *([Ticks(self._grid)] if self._grid else [])})
        self._hyperperiod = lcm(*(ticks.period for ticks in self._cycles))
        self._phases: dict[int, _Phase] = {}
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

    def start(self) -> None:
        """Evaluates the environment at time 0. Raises EnvironmentFailure with what it raises."""
        if self._environment is None:
            return
        try:
            self._environment.start()
        except BaseException as error:
            self._fail(error)

    def _fail(self, error: BaseException) -> NoReturn:
        """The environment has raised ``error``."""
        if stopping.ends_run(error):
            raise error
        raise failure_of(type(self._environment).__name__, error) from error

    def after(self, instant: int) -> int | None:
        """The next instant after ``instant``."""
        if not self._cycles:
            return None
        return instant + self._phase(instant % self._hyperperiod).distance

    def _phase(self, phase: int) -> _Phase:
        found = self._phases.get(phase)
        if found is None:
            found = _Phase(min([ticks.after(phase) for ticks in self._cycles]) - phase, self._actions(phase))
            if len(self._phases) < _REMEMBERED:
                self._phases[phase] = found
        return found

    def _after_phase(self, phase: _Phase, next_instant: int) -> _Phase:
        """The phase after ``phase``, that of ``next_instant``; a phase that is not remembered is not noted either."""
        position = next_instant % self._hyperperiod
        following = self._phase(position)
        if position in self._phases:
            phase.following = following
        return following

    def periods_at(self, instant: int) -> list[int]:
        """The sample periods whose tick ``instant`` is."""
        return list(dict.fromkeys(ticks.period for ticks in self._sampled if ticks.at(instant)))

    def meet(self, instant: int, present: int = 0) -> int | None:
        """Does what happens at ``instant`` before any process runs, except timers. Returns the next instant after it.

        If it is already ``present``, only the last one of several ticks that have passed calls the driver.
        """
        if not self._cycles:
            return None
        phase = self._phase(instant % self._hyperperiod)
        actions = phase.actions
        if present and actions is not None and present - instant >= self._cycles[0].period:
            actions = self._actions(instant % self._hyperperiod, present - instant)
        if actions is not None:
            try:
                self._advance(instant)
            except BaseException as error:
                self._fail(error)
            for action in actions:
                action()
        return instant + phase.distance

    def pass_in_virtual_time(
        self, instant: int, end: int, scheduler: Scheduler, run_ready: Callable[[], bool], root: Task
    ) -> int:
        """Meets ``instant``, which is on the grid or a tick. Then lets processes run, and meets the next instants, as
        long as nothing else happens: before ``end``, the program ends, no process waits for a port, a timer falls due
        or a signal has arrived. Returns the next instant.

        The same as ``meet`` and an iteration of the run, for each instant, in half the time.
        """
        advance = self._advance
        heap = scheduler.timers.heap
        phase = self._phase(instant % self._hyperperiod)
        while True:
            scheduler.now = instant
            try:
                advance(instant)
            except BaseException as error:
                self._fail(error)
            for action in phase.actions or ():
                action()
            now, instant = instant, instant + phase.distance
            if heap and heap[0] <= now:
                return instant
            while run_ready():
                stopping.check()
            if instant >= end or root.ended or stopping.signal or (heap and heap[0] <= instant):
                return instant
            awaited = self.awaited_end
            if (
                awaited is None or (awaited.waiter is None and not awaited.alternative_waits())
            ) and not self.port_can_have_effect():
                return instant
            phase = phase.following or self._after_phase(phase, instant)

    def _actions(self, phase: int, late: int = 0) -> Actions | None:
        if not any(ticks.at(phase) for ticks in self._cycles):
            return None
        inputs: list[SampledInput[Any] | EventInput[Any]] = []
        outputs: list[SampledOutput[Any]] = []
        for port in self._ports:
            match port:
                case SampledInput():
                    if port.ticks.at(phase):
                        inputs.append(port)
                case EventInput():
                    if port.polled and phase % self._grid == 0 and self._grid > late:
                        inputs.append(port)
                case SampledOutput():
                    if port.ticks.at(phase) and not port.immediate:
                        outputs.append(port)
                case EventOutput():
                    pass
        return tuple(_in_turn((*inputs, *outputs), late))

    def port_can_have_effect(self) -> bool:
        """Whether anything at a later instant, except timers, can make a process ready or hand over a value."""
        likely = self._likely_port
        if likely is None or not likely.can_have_effect:
            likely = self._likely_port = next((port for port in self._ports if port.can_have_effect), None)
        self.awaited_end = likely.awaited_end if isinstance(likely, SampledInput) else None
        return likely is not None
