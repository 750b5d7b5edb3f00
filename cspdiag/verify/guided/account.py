"""A run of the program as a counterexample: which process does what, and where that is in the text."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence

from cspdiag.base.record import record, replaced
from cspdiag.model.types import BoolType, EnumType, IntType, RealType, TimeType, Type
from cspdiag.network.dump.expression import value_text
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.counterexamples.counterexample import (
    SILENT,
    BlockedProcess,
    Counterexample,
    Party,
    Step,
    absent_processes,
    ring,
)
from cspdiag.proofs.transitions.systems.system import INTERNAL, Place, System
from cspdiag.verify.guided.script import Actor, Happened, Standing
from cspdiag.verify.runs.names import UNFIT, WRITTEN, duration_of, fit
from cspdiag.verify.runs.values import types_of

_UNSEEN = SILENT | {"exception"}


@record
class _Match:
    """An event that is what happened, with the components that represent the actors."""

    event: int
    actors: tuple[int, ...]
    fit: int


def with_steps_of(
    found: Counterexample,
    system: System,
    run: Sequence[Happened],
    standing: Sequence[Standing],
    network: CoreNetwork,
    round_from: int | None = None,
) -> Counterexample:
    """The counterexample with the steps of another run, and with the processes that wait after it; the steps from
    ``round_from`` on are repeated forever.
    """
    types = types_of(network)
    follower = _Follower(system, network.top)
    steps = tuple(follower.step(happened, _text(happened, types)) for happened in run)
    waiting = tuple(map(follower.waiting, standing))
    cycle = () if round_from is None else steps[round_from:]
    return replaced(found, steps=steps[:round_from], cycle=cycle, waiting=waiting, ring=ring(waiting))


def _text(happened: Happened, types: Mapping[str, Type]) -> str | None:
    type_ = types.get(happened.channel)
    if happened.action != "communication" or not isinstance(type_, BoolType | EnumType | IntType | RealType | TimeType):
        return None
    return value_text(happened.value, type_)


class _Follower:
    """Follows a run in each component separately: in which states it may be, as far as is known from its own steps."""

    def __init__(self, system: System, process: str) -> None:
        self._system = system
        self._prefix = f"{process}."
        self._states = [frozenset((component.initial,)) for component in system.components]
        self._named: dict[str, list[int]] = defaultdict(list)
        for number, event in enumerate(system.events):
            if event.kind == "time":
                self._named[""].append(number)
            elif event.kind not in _UNSEEN:
                self._named[event.channel].append(number)

    def step(self, happened: Happened, value: str | None) -> Step:
        """What happened as a step, without places if the components do not give them.

        Because of values that proofs do not follow, a component may be in several states that offer the same: the place
        is then that of the run.
        """
        if happened.action == "skip":
            return Step("internal", "", None, self._without_places(happened))
        for actors in (happened.actors, happened.actors[1:], happened.actors[:1]):
            matches = list(self._matches(happened, actors, value)) if actors else []
            if matches:
                best = min(matches, key=lambda match: (match.fit, self._is_elsewhere(match, actors)))
                places = {number: actor.place for number, actor in zip(best.actors, actors, strict=True)}
                same = [match for match in matches if match.actors == best.actors]
                return self._taken(value, best, same, places)
        return Step("communication", happened.channel, value, self._without_places(happened))

    def _without_places(self, happened: Happened) -> tuple[Party, ...]:
        return tuple(Party(actor.path.removeprefix(self._prefix), actor.path) for actor in happened.actors)

    def waiting(self, stands: Standing) -> BlockedProcess:
        """A process that never continues."""
        actor = stands.actor
        candidates = [
            (self._fit(actor, number), number, state)
            for number, component in enumerate(self._system.components)
            if component.process and self._fit(actor, number) < UNFIT
            for state in self._reached(number)
            if self._channels(number, state) == stands.channels
        ]
        if not candidates:
            name = actor.path.removeprefix(self._prefix)
            return BlockedProcess(name, actor.path, "waits", None, tuple(sorted(stands.channels)), ())
        _, number, state = min(
            candidates,
            key=lambda one: (one[0], self._can_continue(one[1], one[2]), not self._is_at(one[1], one[2], actor.place)),
        )
        component, events = (
            self._system.components[number],
            [self._system.events[e] for e in self._waits(number, state)],
        )
        place = component.places.get(state, Place("waits"))
        others = dict.fromkeys(
            self._system.components[partner].name.removeprefix(self._prefix)
            for event in events
            for party in event.parties
            if party != number
            for partner in absent_processes(self._system, party, event.role(number))
        )
        channels = dict.fromkeys(event.channel for event in events)
        name = component.name.removeprefix(self._prefix)
        return BlockedProcess(name, component.path, place.words, place.span, tuple(channels), tuple(others))

    def _waits(self, component: int, state: int) -> Sequence[int]:
        """The events for which a component waits in a state, except the end of all that runs in parallel with it."""
        events = sorted({event for event, _ in self._edges(component, state)} - {INTERNAL})
        return [event for event in events if self._system.events[event].kind not in _UNSEEN - {"delivered"}]

    def _can_continue(self, component: int, state: int) -> bool:
        """Whether a component leaves a state by itself, so it is not at rest there."""
        return any(event == INTERNAL for event, _ in self._edges(component, state))

    def _is_at(self, component: int, state: int, at: str | None) -> bool:
        return is_at(self._system.components[component].places.get(state, Place("")), at)

    def _channels(self, component: int, state: int) -> frozenset[str]:
        return frozenset(
            self._system.events[event].channel.partition(" (")[0] for event in self._waits(component, state)
        )

    def _matches(self, happened: Happened, actors: Sequence[Actor], value: str | None) -> Iterator[_Match]:
        for number in self._possible(happened, value):
            event = self._system.events[number]
            processes = [party for party in event.parties if self._system.components[party].process]
            if len(processes) != len(actors) or not all(self._offers(party, number) for party in processes):
                continue
            for order in (processes, processes[::-1])[: len(processes)]:
                fits = [self._fit(actor, party) for actor, party in zip(actors, order, strict=True)]
                if max(fits) < UNFIT:
                    yield _Match(number, tuple(order), sum(fits))

    def _is_elsewhere(self, match: _Match, actors: Sequence[Actor]) -> bool:
        """Whether a component can only do this in another line than its actor did."""
        return any(
            actor.place is not None and not self._has_place(number, match.event, actor.place)
            for number, actor in zip(match.actors, actors, strict=True)
        )

    def _has_place(self, component: int, event: int, at: str) -> bool:
        return any(self._is_at(component, state, at) for state in self._offering(component, event))

    def _possible(self, happened: Happened, value: str | None) -> Iterable[int]:
        if happened.action in {"wait", "after"}:
            events = self._system.events
            times = [n for n in self._named[""] if events[n].channel.rpartition(": ")[2].startswith(happened.action)]
            return [n for n in times if duration_of(events[n].channel) in (None, happened.value)]
        written = self._named.get(f"{happened.channel}{WRITTEN}", ()) if happened.action == "write" else ()
        missed = happened.action == "miss"
        possible = written or [
            number
            for number in self._named.get(happened.channel, ())
            if (self._system.events[number].kind == "miss") == missed
        ]
        with_value = [number for number in possible if self._system.events[number].value == value]
        # A value that the proof does not follow may be the same as one that it follows elsewhere.
        return [
            *with_value,
            *(n for n in possible if self._system.events[n].value is None and value is not None),
        ] or possible

    def _fit(self, actor: Actor, party: int) -> int:
        component = self._system.components[party]
        return fit(actor, component.name, component.path)

    def _offers(self, component: int, event: int) -> bool:
        return any(True for _ in self._offering(component, event))

    def _offering(self, component: int, event: int) -> Iterator[int]:
        """The states that a component may be in, in which it takes part in an event."""
        return (
            state
            for state in self._reached(component)
            if any(taken == event for taken, _ in self._edges(component, state))
        )

    def _edges(self, component: int, state: int) -> Sequence[tuple[int, int]]:
        return self._system.components[component].edges[state]

    def _reached(self, component: int) -> Sequence[int]:
        """The states in which a component may be after invisible steps."""
        reached = dict.fromkeys(self._states[component])
        pending = list(reached)
        while pending:
            for event, target in self._edges(component, pending.pop()):
                unseen = event == INTERNAL or self._system.events[event].kind in _UNSEEN
                if unseen and target not in reached:
                    reached[target] = None
                    pending.append(target)
        return list(reached)

    def _taken(self, value: str | None, best: _Match, same: Sequence[_Match], places: Mapping[int, str | None]) -> Step:
        """The step; from now on the components are in the states to which it leads, with any value."""
        event = self._system.events[best.event]
        parties = tuple(
            replaced(self._party(number, best.event, places.get(number)), role=event.role(number))
            for number in event.parties
        )
        events = {match.event for match in same}
        for number in event.parties:
            after = frozenset(
                target
                for state in self._reached(number)
                for taken, target in self._edges(number, state)
                if taken in events
            )
            self._states[number] = after or self._states[number]
        return Step(event.kind, event.channel, value or event.value, parties)

    def _party(self, number: int, event: int, at: str | None) -> Party:
        component = self._system.components[number]
        states = self._offering(number, event)
        places = [component.places[state] for state in states if state in component.places]
        place = min(places, key=lambda place: not is_at(place, at), default=Place(""))
        name = component.name.removeprefix(self._prefix)
        return Party(name, component.path, place.words, place.span, branch=component.span)


def is_at(place: Place, at: str | None) -> bool:
    """Whether a place is on the line ``file.csp:12`` of a run, which names files without folders."""
    return place.span is not None and f"{place.span.file.rpartition('/')[2]}:{place.span.line}" == at
