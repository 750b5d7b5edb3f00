"""Counterexamples in the words of the diagram: what happens step by step, and which processes wait for each other in
the end.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import ClassVar, Literal, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import record, replaced
from cspdiag.proofs.transitions.systems.system import INTERNAL, EventKind, Place, System
from cspdiag.proofs.verdict import Move, Refuted

Failure: TypeAlias = Literal["deadlock", "knot", "livelock", "no termination", "refinement"]

SILENT: frozenset[str] = frozenset({"internal", "variable", "start", "end", "cancel", "delivered", "ready", "failure"})
"""Kinds of steps that no diagram shows; they appear only in machine-readable output."""


def is_shown(kind: str, parties: int) -> bool:
    """Whether a step of this kind, with this number of parties, is shown to people."""
    return kind not in SILENT or (kind == "ready" and parties > 1)


@record
class Party:
    """A process that takes part in a step: what it was doing before, and where in the text. ``name`` is its name below
    the outermost process, ``role`` as in ``Event.roles``, ``branch`` the text of a parallel branch whose name is a
    number.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    name: str
    path: str
    words: str = ""
    span: Span | None = None
    role: str = ""
    branch: Span | None = None


@record
class Step:
    """A step of a run; ``channel`` is the hierarchical name as in traces. An ``added`` step is one that the proof left
    out and the replayed program took.
    """

    kind: EventKind | Literal["internal"]
    channel: str
    value: str | None
    parties: tuple[Party, ...]
    added: bool = False

    @property
    def shown(self) -> bool:
        """Whether the step is shown to people; also if in it the guard of an interrupt is found ready."""
        return is_shown(self.kind, len(self.parties))


@record
class BlockedProcess:
    """A process that never continues, what it waits for, the hierarchical names of the channels it waits on, and the
    names of the processes that would have to take part (``partners``).

    ``ended`` are the partners that have ended.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    name: str
    path: str
    words: str
    span: Span | None
    channels: tuple[str, ...]
    partners: tuple[str, ...]
    ended: tuple[str, ...] = ()


@record
class Counterexample:
    """A run in which a property fails.

    ``steps`` lead to the failure; ``cycle`` can repeat forever from there; ``waiting`` are the processes that never
    continue, of which those named in ``ring`` wait for each other: each for the next, the last for the first.
    """

    failure: Failure
    steps: tuple[Step, ...]
    cycle: tuple[Step, ...] = ()
    waiting: tuple[BlockedProcess, ...] = ()
    ring: tuple[str, ...] = ()
    process: str = ""
    """The outermost process, with which the names of channels begin."""
    reason: str = ""
    """For ``refinement``: the event that is not allowed, or what is refused although it must be offered."""


def counterexample(
    system: System, refuted: Refuted, failure: Failure, process: str = "", reason: str = ""
) -> Counterexample:
    """The counterexample of a refuted system with ``process`` as its outermost process."""
    describer = _Describer(system, process)
    state = list(system.initial)
    steps = tuple(describer.steps(state, refuted.trace))
    stopped = tuple(state)
    cycle = tuple(describer.steps(state, refuted.cycle))
    waiting = tuple(describer.waiting(stopped, refuted.stuck))
    return Counterexample(failure, steps, cycle, waiting, ring(waiting), process, reason)


class _Describer:
    """Components, events and states in the words of the diagram."""

    def __init__(self, system: System, process: str) -> None:
        self._system = system
        self._prefix = f"{process}."

    def steps(self, state: list[int], moves: Iterable[Move]) -> Iterator[Step]:
        """The moves as steps; updates ``state``."""
        for move in moves:
            parties = tuple(self._party(component, state[component]) for component, _ in move.moves)
            if move.event == INTERNAL:
                yield Step("internal", "", None, parties)
            else:
                event = self._system.events[move.event]
                roles = (event.role(component) for component, _ in move.moves)
                parties = tuple(replaced(party, role=role) for party, role in zip(parties, roles, strict=True))
                yield Step(event.kind, event.channel, event.value, parties)
            for component, after in move.moves:
                state[component] = after

    def _name(self, index: int) -> str:
        return self._system.components[index].name.removeprefix(self._prefix)

    def _party(self, index: int, state: int) -> Party:
        component = self._system.components[index]
        place = component.places.get(state, Place(""))
        return Party(self._name(index), place.path or component.path, place.words, place.span, branch=component.span)

    def waiting(self, state: tuple[int, ...], stuck: Iterable[int]) -> Iterator[BlockedProcess]:
        """The processes among ``stuck`` that have not ended."""
        components = self._system.components
        offered = [{event for event, _ in component.edges[at]} for component, at in zip(components, state, strict=True)]
        for index in sorted(stuck):
            if not components[index].process or state[index] in components[index].terminal:
                continue
            absent = dict.fromkeys(
                partner
                for event in sorted(offered[index] - {INTERNAL})
                for other in self._system.events[event].parties
                if event not in offered[other]
                for partner in absent_processes(self._system, other, self._system.events[event].role(index))
            )
            channels = dict.fromkeys(
                self._system.events[event].channel for event in sorted(offered[index] - {INTERNAL})
            )
            party = self._party(index, state[index])
            words = party.words or "waits"
            partners = tuple(dict.fromkeys(map(self._name, absent)))
            ended = tuple(self._name(other) for other in absent if self._has_ended(other, state[other]))
            yield BlockedProcess(
                party.name, components[index].path, words, party.span, tuple(channels), partners, ended
            )

    def _has_ended(self, index: int, state: int) -> bool:
        """Whether a process has ended, rather than waiting for its branches or to be started."""
        component = self._system.components[index]
        if not component.process or state not in component.terminal:
            return False
        events = [self._system.events[event] for event, _ in component.edges[state] if event != INTERNAL]
        return all(event.kind in ("end", "cancel") and event.parties[0] != index for event in events)


def absent_processes(system: System, absent: int, role: str) -> Iterable[int]:
    """The processes that would have to take part for a party that is absent: the party itself, or, if it is the memory
    of a channel, the processes on the other side of the channel than the one with ``role`` that waits.
    """
    if system.components[absent].process:
        return (absent,)
    others = "!" if role == "?" else "?"
    return (
        partner
        for event in system.events
        if absent in event.parties and len(event.parties) == len(event.roles)
        for partner in event.parties
        if event.role(partner) == others
    )


def ring(waiting: tuple[BlockedProcess, ...]) -> tuple[str, ...]:
    """Names of processes that wait for each other in a ring; empty if there is no ring."""
    by_name = {entry.name: entry for entry in waiting}
    branches: dict[str, list[str]] = {}
    for entry in waiting:
        branches.setdefault(entry.path.partition(".")[2], []).append(entry.name)
    settled: set[str] = set()
    for start in by_name:
        path: list[str] = []
        pending = [iter((start,))]
        while pending:
            name = next(pending[-1], None)
            if name is None:
                pending.pop()
                if path:
                    settled.add(path.pop())
            elif name in path:
                return tuple(path[path.index(name) :])
            elif name in by_name and name not in settled:
                path.append(name)
                pending.append(iter(_meant(by_name[name].partners, by_name, branches)))
    return ()


def _meant(
    partners: Iterable[str], by_name: Mapping[str, BlockedProcess], branches: Mapping[str, Iterable[str]]
) -> Iterator[str]:
    """The partners that wait; in place of a process that waits for its parallel branches, those branches that wait."""
    for partner in partners:
        if partner in by_name:
            yield partner
        else:
            yield from branches.get(partner, ())
