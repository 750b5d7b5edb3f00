"""Symbolic execution of a program at compile time, on the semantics of the language: all its tasks, channels and the
time.

Values are unknown, except for variables that only count. Computations, samples and values that are passed are recorded.
If control flow depends on an unknown value, ``decisions`` say where to continue; when they are used up, the execution
stops there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

from cspdiag.base.record import record
from cspdiag.model.sampling import Sampling
from cspdiag.network.ir.actions import ChannelEnd, End, PortEnd, ProcessScope
from cspdiag.network.ir.expressions import Expression, LiteralValue
from cspdiag.network.ir.network import CreatedChoice, ExternalPort, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.optimize.fuse.code import Code, Failure, NotStaticError
from cspdiag.optimize.fuse.media import Input, Medium, NonBlocking, Offer, channel_medium
from cspdiag.optimize.fuse.record import Recorder
from cspdiag.optimize.fuse.walker import FailureError, Walker
from cspdiag.semantics.choice import Choose
from cspdiag.semantics.ends import choices
from cspdiag.semantics.media import EndKey, Place
from cspdiag.semantics.requests import Parent, Run, Task
from cspdiag.semantics.scheduler import Scheduler

LARGEST_NUMBER_OF_TURNS = 1000
"""Turns of tasks that are executed at most; a longer schedule would not be worth its memory."""


@record
class Ends:
    """The program ends, by an exception if ``failure`` is not None."""

    failure: Failure | None


@record
class Repeats:
    """The program has returned to an earlier state, in which it was at the instant ``since``, after ``position``
    occurrences.
    """

    position: int
    since: int


@record
class NeedsDecision:
    """What follows depends on a condition."""

    condition: Expression


Outcome: TypeAlias = Ends | Repeats | NeedsDecision


class _OutcomeError(Exception):
    def __init__(self, outcome: Outcome) -> None:
        super().__init__()
        self.outcome = outcome


class _UnknownEnvironment:
    """An environment whose samples are unknown."""

    grid = Sampling(2**63)

    def advance(self, now: int) -> None:
        """Nothing changes."""

    def output(self, port: str) -> None:
        """An unknown value."""

    def give(self, port: str, value: object) -> None:
        """Ignored: outputs are recorded where they are written."""


class SymbolicRun(Scheduler):
    """The state of a program at an instant, with what has occurred so far."""

    def __init__(
        self, code: Code, ports: Sequence[ExternalPort], counting: frozenset[str], decisions: Sequence[bool]
    ) -> None:
        super().__init__(code.entry.name, _UnknownEnvironment(), timeouts=True)
        self.code = code
        self.record = Recorder(code.entry, counting)
        self._decisions = decisions
        self._decided = 0
        self._seen: dict[object, tuple[int, int]] = {}
        self._walkers: list[Walker] = []
        self._owners = _owners(code.entry)
        self._memories: dict[str, dict[str, int]] = {}
        """By the name of an alternative, the guard that it chose last."""
        self._numbers = {name: number for number, name in enumerate(dict.fromkeys(_alternatives(code.entry)))}
        self._sampled: list[Input] = []
        self._ends: dict[EndKey, End] = {}
        self._media: dict[Place, Medium] = {}
        self._make_media(code.entry, ports)
        self._waiting_media = [medium for medium in self._media.values() if not isinstance(medium, NonBlocking)]
        self._period = math.lcm(*(port.sampling.period for port in self._sampled)) if self._sampled else 1

    def _make_media(self, entry: ProcessClass, ports: Sequence[ExternalPort]) -> None:
        readers: dict[Place, list[EndKey]] = {}
        for end in entry.creation:
            if isinstance(end, PortEnd | ChannelEnd):
                key = self.key_of(end)
                self._ends[key] = end
                readers.setdefault(_place(end), []).append(key)
        for channel in entry.channels:
            place: Place = (channel.name, None)
            self._media[place] = channel_medium(self.record, self, channel, readers.get(place, []))
        for port in ports:
            place = (port.name.partition("[")[0], port.index)
            if port.direction == "out":
                self._media[place] = NonBlocking(self.record, self, port.name)
            elif port.sampling is not None:
                self._media[place] = self._input(port.name, port.sampling, readers.get(place, []))

    def _input(self, name: str, sampling: Sampling, ends: Sequence[EndKey]) -> Input:
        sampled = Input(self.record, self, name, sampling)
        for end in ends:
            sampled.register(end)
        if ends:
            self.inputs.append(sampled)
            self._sampled.append(sampled)
        return sampled

    def medium_of(self, end: End) -> Medium:
        """The medium of an end. Raises NotStaticError if that is an input without a period."""
        medium = self._media.get(_place(end))
        if medium is None:
            raise NotStaticError(f"the instants of events at {_place(end)[0]} are not known")
        return medium

    def key_of(self, end: End) -> EndKey:
        """The end as one of the process that it belongs to."""
        name, index = _place(end)
        return (self._owners.get(end, ""), name, index, end.end)

    def alternative(self, name: str, *, prioritized: bool) -> Choose:
        """An alternative without guards."""
        memory = {} if prioritized else self._memories.setdefault(name, {})
        return Choose(prioritized, memory, self._numbers[name])

    def follow(self) -> Outcome:
        """Execute to the end, to a repeated state, or to where a decision is missing. Raises NotStaticError."""
        try:
            ending = self.run(Walker(self, (0,), 0), None)
        except _OutcomeError as found:
            return found.outcome
        if ending.ended == "deadlock":
            raise NotStaticError("it deadlocks")
        return Ends(self.failure.failure if isinstance(self.failure, FailureError) else None)

    def start(self, steps: Run, priority: tuple[int, ...], parent: Parent | None) -> Task:
        """Start a branch."""
        assert isinstance(steps, Walker)
        steps.task = super().start(steps, priority, parent)
        self._walkers.append(steps)
        return steps.task

    def samplings(self) -> list[Sampling]:
        """Those of the inputs that some process follows."""
        return [port.sampling for port in self._sampled if port.sessions]

    def instant(self, now: int) -> None:
        """Everything that happens at an instant before tasks run."""
        self.record.now = now
        self.record.count_instruction()
        super().instant(now)

    def next_task(self, ready: Sequence[Task]) -> Task:
        """The task of the next turn, after a check for a repeated state."""
        self._walkers = [walker for walker in self._walkers if not walker.task.ended]
        self.remember()
        return super().next_task(ready)

    def followed_since(self) -> dict[End, int]:
        """The instants at which the ends of sampled inputs were first read or waited for."""
        return {self._ends[end]: since for port in self._sampled for end, since in port.since.items()}

    def folded(self, expression: Expression) -> Expression:
        """The expression, or its value if that is known."""
        return self.record.folded(expression)

    def compute_in_advance(self, offer: Offer) -> None:
        """Compute the value of one of several offers before any of them is made."""
        self.record.compute_in_advance(offer)

    def holds(self, condition: Expression) -> bool:
        """Whether a condition holds, by its value if it is known, otherwise by the next decision."""
        value = self.folded(condition)
        if isinstance(value, LiteralValue):
            return value.value is True
        if self._decided == len(self._decisions):
            raise _OutcomeError(NeedsDecision(condition))
        taken = self._decisions[self._decided]
        self._decided += 1
        self.record.decide(condition, taken)
        return taken

    def close(self, process: ProcessScope) -> None:
        """A process has ended."""
        if process.ends:
            self.record.close(process)
        self.process_ended(process.instance)

    def remember(self) -> None:
        """Record the state; stop if the program has been in it before."""
        state = self._state()
        happened = len(self.record.occurrences)
        before = self._seen.get(state)
        if before is not None:
            position, since = before
            if since == self.now and position == happened:
                raise NotStaticError("it runs forever without doing anything")
            raise _OutcomeError(Repeats(position, since))
        if len(self._seen) > LARGEST_NUMBER_OF_TURNS:
            raise NotStaticError(f"it takes more than {LARGEST_NUMBER_OF_TURNS} turns until it repeats")
        self._seen[state] = (happened, self.now)

    def _state(self) -> object:
        return (
            None if self.running is None else _key(self.running),
            self.now % self._period,
            tuple(map(_key, self.ready)),
            tuple(walker.state(self.now) for walker in self._walkers),
            tuple(_key(request.task) for request in self.waiting),
            tuple(medium.state() for medium in self._waiting_media),
            tuple(sorted((name, memory["last"]) for name, memory in self._memories.items() if memory)),
            self.record.knowledge(),
        )


def _key(task: Task) -> tuple[int, ...]:
    assert isinstance(task.steps, Walker)
    return task.steps.key


def _place(end: End) -> Place:
    return (end.port, end.index) if isinstance(end, PortEnd) else (end.channel, None)


def _alternatives(entry: ProcessClass) -> Iterator[str]:
    """The alternatives in the order in which they are created, which is the order in which they are served."""
    assert entry.body is not None
    yield from (made.choice for made in entry.creation if isinstance(made, CreatedChoice))
    yield from (choice.name for choice in choices(entry.body))


def _owners(entry: ProcessClass) -> Mapping[End, str]:
    """By end, the inlined process to which it belongs."""
    scopes = (part for part in parts(entry.body) if isinstance(part, ProcessScope))
    return {end: scope.instance for scope in scopes for end in scope.ends}
