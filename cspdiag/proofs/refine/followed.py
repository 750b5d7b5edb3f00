"""A process that its specification follows: what a search through both looks for."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.base.record import record, replaced
from cspdiag.proofs.refine.labels import Label
from cspdiag.proofs.refine.normal_form import NormalNode
from cspdiag.proofs.transitions.systems.system import Component, System
from cspdiag.proofs.verdict import Move


@record
class Followed:
    """A process with the normal form of its specification as one more component, the last, whose states are the
    ``nodes`` and one more that means that an event was not allowed. ``seen`` are the labels of the events that the
    specification sees.
    """

    system: System
    seen: dict[int, Label]
    nodes: tuple[NormalNode, ...]

    def offers(self, state: Sequence[int]) -> set[Label]:
        """The labels of the events that are possible in a state."""
        return {
            label
            for number, label in self.seen.items()
            if all(self._takes_part(party, state, number) for party in self.system.events[number].parties)
        }

    def has_ended(self, state: Sequence[int]) -> bool:
        """Whether all processes have ended in a state."""
        return all(
            local in component.terminal
            for local, component in zip(state, self.system.components, strict=True)
            if component.process
        )

    def _takes_part(self, party: int, state: Sequence[int], number: int) -> bool:
        return any(event == number for event, _ in self.system.components[party].edges[state[party]])


@record
class Searched:
    """The result of a search: how many states it reached, and, if it found a violation, a shortest trace to it, which
    has the moves of the specification, too, and the state after it.
    """

    states: int
    trace: tuple[Move, ...] = ()
    violation: tuple[int, ...] | None = None


def followed(system: System, seen: dict[int, Label], nodes: tuple[NormalNode, ...]) -> Followed:
    """The process, followed by its specification."""
    watcher = len(system.components)
    edges = tuple(tuple((event, node.after.get(label, len(nodes))) for event, label in seen.items()) for node in nodes)
    events = tuple(
        replaced(event, parties=(*event.parties, watcher)) if number in seen else event
        for number, event in enumerate(system.events)
    )
    component = Component("specification", (*edges, ()), process=False)
    return Followed(System((*system.components, component), events), seen, nodes)
