"""Whether processes of any number of elements can continue forever among themselves, from the loops of the few
different components that elements consist of.

In an infinite run of a finite network, each component takes some of its edges infinitely often. These are a strongly
connected part of its graph, and every event with one of them is one that its other party takes infinitely often, too.
Mapping the components of the large network to those of the small one that do the same, and events to what they are
between (``End``), keeps both, as a map onto a quotient by symmetry keeps paths and cycles (Clarke, Enders, Filkorn and
Jha, "Exploiting symmetry in temporal logic model checking", 1996; Emerson and Sistla, "Symmetry and model checking",
1996). The quotient may have cycles that the network does not have, so only their absence proves something. There are
two ways to show it, which are used in turns until nothing changes:

- An end that lies on no loop of any component, among ends that are left, is not repeated forever, and neither is the
  other end of its joint.
- If no component can repeat an event forever without another one, and none can repeat that without a third, the indexes
  of their elements cannot grow, or fall, forever (``has_no_circle``): so no such event is repeated.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from itertools import islice, product
from typing import TypeAlias

from cspdiag.base.record import record, replaced
from cspdiag.proofs.properties.livelock import is_hidden
from cspdiag.proofs.rules.elements import Elements, End
from cspdiag.proofs.rules.marked_graph import Place, has_no_circle
from cspdiag.proofs.search.local_loops import looping, offered_by
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, Edge, Event, System

MOST_CHOICES = 1000
"""Ways in which events can be taken to need others; more are not tried."""


@record
class _SeveralEnds:
    """An end of the events of interchangeable elements: which elements they are does not matter."""

    joint: str
    writes: bool


AnyEnd: TypeAlias = "End | _SeveralEnds"


@record
class Parts:
    """The different components that elements consist of, with only their hidden steps; their events are positions in
    ``ends``.
    """

    components: tuple[Component, ...]
    ends: tuple[AnyEnd, ...]

    def ends_of_joints(self) -> dict[Hashable, list[int]]:
        """The positions of the ends of each joint."""
        found: dict[Hashable, list[int]] = {}
        for number, end in enumerate(self.ends):
            found.setdefault(end.joint, []).append(number)
        return found


def parts_of_elements(system: System, elements: Elements) -> Parts:
    """The components of elements that are joined to certain others. Raises ``elements.NoFormError``."""
    joints = {number: elements.joint(event) for number, event in _shared(system)}
    return _parts(system, lambda number, writes: End(joints[number], writes))


def interchangeable_parts(system: System) -> Parts:
    """The components of interchangeable elements. What one of them does with different elements is taken to be the
    same, so it has the same loops for any number of elements, or fewer.
    """
    names = {number: _without_indexes(event.channel) for number, event in _shared(system)}
    parts = _parts(system, lambda number, writes: _SeveralEnds(names[number], writes))
    return replaced(parts, components=tuple(map(_merged, parts.components)))


def _shared(system: System) -> Iterable[tuple[int, Event]]:
    return ((number, event) for number, event in enumerate(system.events) if len(event.parties) > 1)


def _without_indexes(channel: str) -> str:
    return re.sub(r"\[\d+\]", "", channel)


def _parts(system: System, end_of: Callable[[int, bool], AnyEnd]) -> Parts:
    numbers: dict[AnyEnd, int] = {}
    found: dict[tuple[tuple[Edge, ...], ...], Component] = {}
    for party, component in enumerate(system.components):
        edges = tuple(
            tuple(
                dict.fromkeys(
                    (_renamed(system, event, party, end_of, numbers), after)
                    for event, after in offered
                    if event == INTERNAL or is_hidden(system.events[event])
                )
            )
            for offered in component.edges
        )
        found.setdefault(edges, replaced(component, edges=edges))
    return Parts(tuple(found.values()), tuple(numbers))


def _renamed(
    system: System, number: int, party: int, end_of: Callable[[int, bool], AnyEnd], numbers: dict[AnyEnd, int]
) -> int:
    """The number of the end at a component; a hidden step that it takes by itself is internal."""
    if number == INTERNAL or len(system.events[number].parties) == 1:
        return INTERNAL
    return numbers.setdefault(end_of(number, system.events[number].role(party) == "!"), len(numbers))


def _merged(component: Component) -> Component:
    """The smallest component with the same steps, up to bisimilarity; the loops of the component are loops of it."""
    block = [0] * len(component.edges)
    while True:
        number: dict[Hashable, int] = {}
        steps = [frozenset((event, block[after]) for event, after in offered) for offered in component.edges]
        refined = [number.setdefault(key, len(number)) for key in zip(block, steps, strict=True)]
        if max(refined) == max(block):
            break
        block = refined
    edges = {block[state]: tuple(sorted(step)) for state, step in enumerate(steps)}
    return Component(component.name, tuple(edges[state] for state in sorted(edges)), initial=block[component.initial])


def all_loops_end(parts: Parts, place: Callable[[End, End], Place] | None = None) -> bool:
    """Whether no network that consists of any number of these parts takes infinitely many of their steps; False if that
    is not known. ``place`` says how far apart two events of a component are.
    """
    joints = parts.ends_of_joints()
    left = {number for ends in joints.values() if len(ends) == 2 for number in ends}
    components: Sequence[Component] = parts.components
    while True:
        components = [looping(component, left | {INTERNAL}) for component in components]
        offered = {number for component in components for number in offered_by(component)}
        kept = {number for ends in joints.values() if offered.issuperset(ends) for number in ends} & left
        if kept == left:
            if not left or place is None:
                return not any(any(component.edges) for component in components)
            kept = left - _ending(replaced(parts, components=tuple(components)), place)
            if kept == left:
                return False
        left = kept


def _ending(parts: Parts, place: Callable[[End, End], Place]) -> set[int]:
    """The ends of joints whose events cannot be repeated forever, because each needs others without end."""
    options = _options(parts, place)
    while True:
        usable = {
            joint: [ways for ways in several if all(way.after in options for way in ways)]
            for joint, several in options.items()
        }
        if usable == options:
            break
        options = {joint: several for joint, several in usable.items() if several}
    for chosen in islice(product(*options.values()), MOST_CHOICES):
        if has_no_circle(way for ways in chosen for way in ways):
            return {number for number, end in enumerate(parts.ends) if end.joint in options}
    return set()


def _options(parts: Parts, place: Callable[[End, End], Place]) -> dict[Hashable, list[tuple[Place, ...]]]:
    """For each joint the ways to say which other events its events need: a place for each different component at one of
    its ends.
    """
    needed = [_needed(component) for component in parts.components]
    found: dict[Hashable, list[tuple[Place, ...]]] = {}
    for number, end in enumerate(parts.ends):
        assert isinstance(end, End)
        ways: list[list[Place]] = [
            [place(end, other) for other in (parts.ends[one] for one in needs[number]) if isinstance(other, End)]
            for needs in needed
            if number in needs
        ]
        if ways:
            found.setdefault(end.joint, []).extend(islice(product(*ways), MOST_CHOICES))
    return {joint: several for joint, several in found.items() if several}


def _needed(component: Component) -> Mapping[int, list[int]]:
    """For each event on a loop of a component the other ones that are on all of these loops."""
    events = offered_by(component)
    needed: dict[int, list[int]] = {event: [] for event in events}
    for without in events:
        repeated = offered_by(looping(component, (events | {INTERNAL}) - {without}))
        for event in events - repeated - {without}:
            needed[event].append(without)
    return needed
