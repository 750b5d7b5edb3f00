"""Further rounds of loops whose end is computed: proofs leave open when such a loop ends, so a trace has as few rounds
as possible.

A process that is not where the trace has it continues by itself until it is there: it reads what the environment
offers, always the same value, writes what the environment takes, and lets delays pass. If a specification sees that,
the judge of the whole run decides in the end whether it is allowed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from cspdiag.base.record import record
from cspdiag.model.constants.durations import duration
from cspdiag.network.dump.expression import value_text
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.runtime.kernel.policy import Option
from cspdiag.verify.decisions import Decisions
from cspdiag.verify.guided.goal import STANDSTILLS
from cspdiag.verify.guided.script import Actor
from cspdiag.verify.replay.gates import Conductor, Gate, Interruption
from cspdiag.verify.runs.names import UNFIT, WRITTEN, belongs, duration_of, fit, is_medium
from cspdiag.verify.runs.task_places import TaskPlaces
from cspdiag.verify.runs.trace import DivergenceError, Trace, TraceStep
from cspdiag.verify.runs.values import Values, is_written_as, types_of

MOST_STEPS = 8_000
"""The number of steps that are added in one attempt."""
MOST_IN_ALL = 50_000
"""The number of steps that are added in all attempts to follow one trace."""

_MEETING = frozenset({"communication", "take", "external", "sample", "miss", "ready"})
_LEAVING = frozenset({"exception", "failure", "end"})
_PREFERRED = ("read", "ready", "write", "wait", "skip", "after")
_ROLES = {"read": "?", "write": "!"}


@record
class Added:
    """A step that the trace does not have, the number of the step that it precedes, and its actor; ``role`` as in
    ``Party``.
    """

    before: int
    step: TraceStep
    actor: Actor
    role: str


class Rounds:
    """Adds rounds to the attempts of one replay. ``added`` are those of the last attempt."""

    def __init__(self, network: CoreNetwork, trace: Trace) -> None:
        self._trace = trace
        self._ports = {f"{network.top}.{port.name}": port for port in network.external_ports}
        self._types = types_of(network)
        names = {name for step in trace.steps for name, _ in step.parties}
        self._names = sorted(names, key=len, reverse=True)
        self._places = TaskPlaces()
        self._left_in_all = MOST_IN_ALL
        self._left = MOST_STEPS
        self._chosen: dict[tuple[str, tuple[Option, ...]], Option] = {}
        self._offered: dict[str, Any] = {}
        self.added: list[Added] = []

    def begin(self, conductor: Conductor, values: Values, decisions: Decisions, settle: Callable[[], None]) -> None:
        """Begins a new attempt, with its decisions; ``settle`` lets all processes continue to a gate."""
        self._conductor, self._values, self._decisions, self._settle = conductor, values, decisions, settle
        self._chosen, self._offered, self.added = {}, {}, []
        self._left = min(MOST_STEPS, self._left_in_all)

    @property
    def exhausted(self) -> bool:
        """Whether no further attempt is to be made."""
        return self._left_in_all <= 0

    def actor(self, candidate: Gate | Interruption) -> Actor:
        """The task of a gate, and where it is now."""
        return Actor(candidate.path, candidate.names, self._places.of(candidate.task, None))

    def reach(self, number: int, step: TraceStep) -> None:
        """Lets the processes of the step with this number continue until they can take it, or have ended."""
        for name, path in self._needed(step):
            if step.kind in _LEAVING:
                self._continue(number, name, path, partial(_has_ended, self._conductor, name, path))
            else:
                self._continue(number, name, path, partial(self._is_ready, step, name, path))

    def bring_to_rest(self) -> None:
        """Lets processes continue until those that are stuck are where the trace has them and, if all are to be at
        rest, until the others have ended.
        """
        number = len(self._trace.steps)
        if self._trace.failure not in STANDSTILLS:
            return
        for path, channels in self._trace.stuck:
            if channels:
                self._continue(number, path, path, partial(_waits, self._conductor, path, channels))
        while self._trace.failure == "deadlock" and self._left > 0:
            moving = [gate for gate in self._conductor.halted.values() if not self._is_stuck(gate)]
            if not any(self._take(number, gate) for gate in moving):
                return

    def _needed(self, step: TraceStep) -> Iterator[tuple[str, str]]:
        """The processes that have to be somewhere for a step."""
        if step.kind in _LEAVING:
            yield from step.parties[1:]
        elif step.kind in _MEETING or step.kind == "time":
            yield from (party for party in step.parties if not is_medium(party[0], step))

    def _continue(self, number: int, name: str, path: str, is_there: Callable[[], bool]) -> None:
        while not is_there():
            if self._left <= 0:
                raise DivergenceError(
                    f"`{path}` goes round, and has not reached the place where it is needed in {MOST_STEPS} steps"
                )
            if not any(self._take(number, gate) for gate in _gates(self._conductor, name, path)):
                return

    def _is_ready(self, step: TraceStep, name: str, path: str) -> bool:
        """Whether a process can take a step, in the same part of it as in the trace."""
        candidates: list[Gate | Interruption] = [*self._conductor.halted.values(), *self._conductor.interruptions]
        return any(
            self._fits(step, option)
            for candidate in candidates
            if fit(candidate, name, path) < UNFIT and (candidate.path + ".").startswith(path + ".")
            for option in candidate.options
        )

    def _fits(self, step: TraceStep, option: Option) -> bool:
        if step.kind == "time":
            lasts = duration_of(step.channel)
            return option.action in ("wait", "after") and lasts in (None, option.duration)
        if option.action not in ("write", "read", "ready") or option.channel != step.channel.removesuffix(WRITTEN):
            return False
        if option.action != "write" or step.value is None:
            return True
        return is_written_as(option.value, self._types[option.channel], step.value)

    def _is_stuck(self, gate: Gate) -> bool:
        return any(belongs(gate.path, path) and _waits_at(gate, channels) for path, channels in self._trace.stuck)

    def _take(self, number: int, gate: Gate) -> bool:
        """A process continues by itself, if it can."""
        options = tuple(filter(self._is_alone, gate.options))
        if not options:
            return False
        self._left -= 1
        self._left_in_all -= 1
        option = self._option(gate.path, options)
        added = Added(number, self._step(gate, option), self.actor(gate), _ROLES.get(option.action, "*"))
        self._conductor.release(gate, option)
        self._settle()
        if option.action != "ready":
            self.added.append(added)
        return True

    def _is_alone(self, option: Option) -> bool:
        """Whether only the environment takes part."""
        return option.channel in self._ports or option.action in ("wait", "skip", "after")

    def _option(self, path: str, options: tuple[Option, ...]) -> Option:
        """What a process continues with wherever it has this choice; samples are preferred."""
        key = path, options
        if key not in self._chosen:
            ordered = sorted(options, key=self._urgency)
            self._chosen[key] = ordered[self._decisions.choose(len(ordered))]
        return options[options.index(self._chosen[key])]

    def _urgency(self, option: Option) -> tuple[int, bool, int]:
        port = self._ports.get(option.channel)
        return _PREFERRED.index(option.action), port is None or port.sampling is None, option.index

    def _step(self, gate: Gate, option: Option) -> TraceStep:
        outer = (name for name in self._names if f"{gate.path}.".startswith(f"{name}."))
        name = next(outer, gate.path)
        parties = ((name, gate.path),)
        port = self._ports.get(option.channel)
        if port is None:
            if option.action == "skip":
                return TraceStep("internal", "", None, parties)
            return TraceStep("time", f"{name}: {option.action} {duration(option.duration)}", None, parties)
        value = self._value(option.channel) if port.direction == "in" else option.value
        kind = "sample" if port.direction == "in" and port.sampling is not None else "external"
        text = None if value is None else value_text(value, port.type)
        return TraceStep(kind, option.channel, text, parties)

    def _value(self, channel: str) -> Any:
        """What the environment offers at an input in all rounds."""
        if channel not in self._offered:
            candidates = self._values.candidates(self._ports[channel].type, None)
            self._offered[channel] = candidates[self._decisions.choose(len(candidates))]
        self._conductor.outside.offered[channel] = self._offered[channel]
        return self._offered[channel]


def _gates(conductor: Conductor, name: str, path: str) -> list[Gate]:
    """The gates at which a process of a trace halts: itself or its branches or, if there are none, the process that
    runs it.
    """
    ranked = [(fit(gate, name, path), gate) for gate in conductor.halted.values()]
    inside = [gate for rank, gate in ranked if rank < UNFIT - 1]
    return inside or [gate for rank, gate in ranked if rank < UNFIT]


def _has_ended(conductor: Conductor, name: str, path: str) -> bool:
    return all(fit(gate, name, path) >= UNFIT - 1 for gate in conductor.halted.values())


def _waits(conductor: Conductor, path: str, channels: frozenset[str]) -> bool:
    return any(belongs(gate.path, path) and _waits_at(gate, channels) for gate in conductor.halted.values())


def _waits_at(gate: Gate, channels: frozenset[str]) -> bool:
    return any(option.channel in channels for option in gate.options if option.channel)
