"""Who does the steps that a replay adds, and where the text says so, as the transition system knows it."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.proofs.counterexamples.counterexample import Party
from cspdiag.proofs.transitions.systems.system import INTERNAL, Event, Place, System
from cspdiag.verify.guided.account import is_at
from cspdiag.verify.replay.rounds import Added
from cspdiag.verify.runs.names import UNFIT, duration_of, fit


class AddedParties:
    """The parties of added steps in a system whose outermost process is ``process``; each is looked up once."""

    def __init__(self, system: System, process: str) -> None:
        self._system = system
        self._prefix = f"{process}."
        self._known: dict[tuple[object, ...], Party] = {}

    def of(self, added: Added) -> Party:
        """Who does a step; without a place where no component of the system offers it."""
        step, actor = added.step, added.actor
        key = step.kind, step.channel, actor, added.role
        if key not in self._known:
            found = min(self._found(added), key=lambda one: one[:2], default=None)
            if found is None:
                ((name, path),) = step.parties
                self._known[key] = Party(name.removeprefix(self._prefix), path, role=added.role)
            else:
                _, _, number, place = found
                component = self._system.components[number]
                self._known[key] = Party(
                    component.name.removeprefix(self._prefix),
                    place.path or component.path,
                    place.words,
                    place.span,
                    added.role,
                    component.span,
                )
        return self._known[key]

    def _found(self, added: Added) -> Iterator[tuple[int, bool, int, Place]]:
        """The places at which a step is offered: how little the component fits, and whether it is in another line."""
        for number, component in enumerate(self._system.components):
            unfit = fit(added.actor, component.name, component.path)
            if unfit >= UNFIT or not component.process:
                continue
            for state, edges in enumerate(component.edges):
                place = component.places.get(state)
                if place is not None and any(self._is_of(added, event) for event, _ in edges):
                    yield unfit, not is_at(place, added.actor.place), number, place

    def _is_of(self, added: Added, event: int) -> bool:
        return _offers(self._system.events[event], added) if event != INTERNAL else added.step.kind == "internal"


def _offers(event: Event, added: Added) -> bool:
    step = added.step
    if step.kind == "time":
        return event.kind == "time" and duration_of(event.channel) in (None, duration_of(step.channel))
    return event.kind in ("external", "sample") and event.channel == step.channel
