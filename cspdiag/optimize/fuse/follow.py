"""Follows at compile time what a program does, by the meaning of the language: all its tasks, their channels and the
time.

Values are not known, but for variables that only count. What happens is written down: computations, samples that are
taken, values that pass. Where the program goes on depends on a value that is not known, ``decisions`` say where to go;
without one for it, following stops there.
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
from cspdiag.optimize.fuse.media import AtOnce, Input, Medium, Offer, channel_medium
from cspdiag.optimize.fuse.record import Recorder
from cspdiag.optimize.fuse.walker import FailureError, Walker
from cspdiag.semantics.choice import Choose
from cspdiag.semantics.ends import choices
from cspdiag.semantics.media import EndKey, Place
from cspdiag.semantics.requests import Parent, Run, Task
from cspdiag.semantics.scheduler import Scheduler

LONGEST = 1000
"""Turns of tasks that are followed at most; a schedule that is longer would not be worth its memory."""


@record
class Ends:
    """The program ends, by an exception if ``failure`` is not None."""

    failure: Failure | None


@record
class Loops:
    """The program is in a state for the second time; it was in it at instant ``since``, when ``position`` things had
    happened.
    """

    position: int
    since: int


@record
class Asks:
    """What follows depends on a condition."""

    condition: Expression


Outcome: TypeAlias = Ends | Loops | Asks


class _FoundError(Exception):
    def __init__(self, outcome: Outcome) -> None:
        super().__init__()
        self.outcome = outcome


class _Unknown:
    """The environment: inputs are sampled, and nobody knows what."""

    grid = Sampling(2**63)

    def advance(self, now: int) -> None:
        """It goes on."""

    def output(self, port: str) -> None:
        """A value that is not known."""

    def give(self, port: str, value: object) -> None:
        """Outputs are written down where they are written."""


class Following(Scheduler):
    """The state of a program at an instant, and what has happened so far."""

    def __init__(
        self, code: Code, ports: Sequence[ExternalPort], counting: frozenset[str], decisions: Sequence[bool]
    ) -> None:
        super().__init__(code.entry.name, _Unknown(), timeouts=True)
        self.code = code
        self.record = Recorder(code.entry, counting)
        self._decisions = decisions
        self._asked = 0
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
        self._waited_at = [medium for medium in self._media.values() if not isinstance(medium, AtOnce)]
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
                self._media[place] = AtOnce(self.record, self, port.name)
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
        """What an end belongs to. Raises NotStaticError where that is an input without a period."""
        medium = self._media.get(_place(end))
        if medium is None:
            raise NotStaticError(f"nobody knows when {_place(end)[0]} has an event")
        return medium

    def key_of(self, end: End) -> EndKey:
        """The end as one of the process that it belongs to."""
        name, index = _place(end)
        return (self._owners.get(end, ""), name, index, end.end)

    def alternative(self, name: str, *, prioritized: bool) -> Choose:
        """An alternative that has no guards yet."""
        memory = {} if prioritized else self._memories.setdefault(name, {})
        return Choose(prioritized, memory, self._numbers[name])

    def follow(self) -> Outcome:
        """Follows to the end, to a state that has been before, or to where a decision is missing. Raises
        NotStaticError.
        """
        try:
            ending = self.run(Walker(self, (0,), 0), None)
        except _FoundError as found:
            return found.outcome
        if ending.ended == "deadlock":
            raise NotStaticError("it deadlocks")
        return Ends(self.failure.failure if isinstance(self.failure, FailureError) else None)

    def start(self, steps: Run, priority: tuple[int, ...], parent: Parent | None) -> Task:
        """A new branch."""
        assert isinstance(steps, Walker)
        steps.task = super().start(steps, priority, parent)
        self._walkers.append(steps)
        return steps.task

    def samplings(self) -> list[Sampling]:
        """Those of the inputs that somebody follows."""
        return [port.sampling for port in self._sampled if port.sessions]

    def instant(self, now: int) -> None:
        """Everything that happens at an instant before tasks run."""
        self.record.now = now
        self.record.count_instruction()
        super().instant(now)

    def next_of(self, ready: Sequence[Task]) -> Task:
        """The next turn: this is where the state of a program is compared with those before."""
        self._walkers = [walker for walker in self._walkers if not walker.task.ended]
        self.remember()
        return super().next_of(ready)

    def followed_since(self) -> dict[End, int]:
        """When the ends of sampled inputs were read, or waited at, for the first time."""
        return {self._ends[end]: since for port in self._sampled for end, since in port.since.items()}

    def folded(self, expression: Expression) -> Expression:
        """The expression, or its value where that is known."""
        return self.record.folded(expression)

    def compute_beside(self, offer: Offer) -> None:
        """The value of one of several offers is computed before any of them is made."""
        self.record.compute_beside(offer)

    def holds(self, condition: Expression) -> bool:
        """Whether a condition holds, as far as it is known, or decided."""
        value = self.folded(condition)
        if isinstance(value, LiteralValue):
            return value.value is True
        if self._asked == len(self._decisions):
            raise _FoundError(Asks(condition))
        taken = self._decisions[self._asked]
        self._asked += 1
        self.record.turn(condition, taken)
        return taken

    def close(self, process: ProcessScope) -> None:
        """A process has ended."""
        if process.ends:
            self.record.close(process)
        self.process_ended(process.instance)

    def remember(self) -> None:
        """Stops where the program is in a state for the second time."""
        state = self._state()
        happened = len(self.record.happenings)
        before = self._seen.get(state)
        if before is not None:
            position, since = before
            if since == self.now and position == happened:
                raise NotStaticError("it goes on forever without doing anything")
            raise _FoundError(Loops(position, since))
        if len(self._seen) > LONGEST:
            raise NotStaticError(f"it takes more than {LONGEST} turns until it repeats")
        self._seen[state] = (happened, self.now)

    def _state(self) -> object:
        return (
            None if self.running is None else _key(self.running),
            self.now % self._period,
            tuple(map(_key, self.ready)),
            tuple(walker.state(self.now) for walker in self._walkers),
            tuple(_key(request.task) for request in self.waiting),
            tuple(medium.state() for medium in self._waited_at),
            tuple(sorted((name, memory["last"]) for name, memory in self._memories.items() if memory)),
            self.record.knowledge(),
        )


def _key(task: Task) -> tuple[int, ...]:
    assert isinstance(task.steps, Walker)
    return task.steps.key


def _place(end: End) -> Place:
    return (end.port, end.index) if isinstance(end, PortEnd) else (end.channel, None)


def _alternatives(entry: ProcessClass) -> Iterator[str]:
    """In the order in which they come to be, which is that in which they are served."""
    assert entry.body is not None
    yield from (made.choice for made in entry.creation if isinstance(made, CreatedChoice))
    yield from (choice.name for choice in choices(entry.body))


def _owners(entry: ProcessClass) -> Mapping[End, str]:
    """The process, of those that are inside, that has an end."""
    scopes = (part for part in parts(entry.body) if isinstance(part, ProcessScope))
    return {end: scope.instance for scope in scopes for end in scope.ends}
