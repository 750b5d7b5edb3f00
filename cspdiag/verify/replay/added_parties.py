"""Who does the steps that a replay adds, and where the text says so, as the transition system knows it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.base.record import replaced
from cspdiag.network.dump.delay import is_of_time_out, until_instant
from cspdiag.proofs.counterexamples.counterexample import Party, Step
from cspdiag.proofs.transitions.systems.system import INTERNAL, Event, Place, System
from cspdiag.verify.guided.account import is_at
from cspdiag.verify.guided.script import Actor
from cspdiag.verify.replay.rounds import Added
from cspdiag.verify.runs.names import UNFIT, duration_of, fit
from cspdiag.verify.runs.trace import TraceStep


class AddedParties:
    """The parties of added steps in a system whose outermost process is ``process``; each is looked up once."""

    def __init__(self, system: System, process: str) -> None:
        self._system = system
        self._prefix = f"{process}."
        self._known: dict[tuple[object, ...], tuple[Party, str]] = {}

    def of(self, added: Added) -> tuple[Party, str]:
        """Who does a step, without a place where no component of the system offers it; and its channel, for a delay
        until an instant as the text has it, as the replay does not let time pass.
        """
        step, actor = added.step, added.actor
        key = step.kind, step.channel, actor, added.role
        if key not in self._known:
            found = min(self._found(added), key=lambda one: one[:3], default=None)
            if found is None:
                ((name, path),) = step.parties
                self._known[key] = Party(name.removeprefix(self._prefix), path, role=added.role), step.channel
            else:
                *_, number, place, channel = found
                component = self._system.components[number]
                party = Party(
                    component.name.removeprefix(self._prefix),
                    place.path or component.path,
                    place.words,
                    place.span,
                    added.role,
                    component.span,
                )
                self._known[key] = party, channel if until_instant(channel) else step.channel
        return self._known[key]

    def where_done(self, step: Step, party: Party, actors: Sequence[Actor]) -> Party:
        """A party of a step of the trace, in the place where its actor was; without a place if the system has none
        there.
        """
        name = f"{self._prefix}{party.name}"
        actor = min(actors, key=lambda one: fit(one, name, party.path), default=None)
        if actor is None or actor.place is None or fit(actor, name, party.path) >= UNFIT:
            return party
        if is_at(Place(party.words, party.span), actor.place):
            return party
        trace_step = TraceStep(step.kind, step.channel, None, ((name, party.path),))
        found, _ = self.of(Added(0, trace_step, actor, party.role))
        if is_at(Place(found.words, found.span), actor.place):
            return replaced(party, words=found.words, span=found.span)
        return replaced(party, span=None)

    def _found(self, added: Added) -> Iterator[tuple[int, bool, bool, int, Place, str]]:
        """The places at which a step is offered: how little the component fits, whether it is in another line, and
        whether a delay may last otherwise; and the channel of the event.
        """
        for number, component in enumerate(self._system.components):
            unfit = fit(added.actor, component.name, component.path)
            if unfit >= UNFIT or not component.process:
                continue
            for state, edges in enumerate(component.edges):
                place = component.places.get(state)
                if place is None:
                    continue
                elsewhere = not is_at(place, added.actor.place)
                for channel in (found for event, _ in edges if (found := self._channel_of(added, event)) is not None):
                    lasts = duration_of(channel) is not None
                    yield unfit, elsewhere, not lasts, number, place, channel

    def _channel_of(self, added: Added, number: int) -> str | None:
        """The channel of an event that is the step; None if it is another one."""
        if number == INTERNAL:
            return "" if added.step.kind == "internal" else None
        event = self._system.events[number]
        return event.channel if _offers(event, added) else None


def _offers(event: Event, added: Added) -> bool:
    step = added.step
    if step.kind == "time":
        same = event.kind == "time" and is_of_time_out(event.channel) == is_of_time_out(step.channel)
        return same and duration_of(event.channel) in (None, duration_of(step.channel))
    return event.kind in ("external", "sample", "communication") and event.channel == step.channel
