"""Proves once what holds for each of many elements of arrays, whatever their number.

The components and the events are those of the same program with fewer elements, whose elements have the same
neighbourhoods, so that each component of the large network does the same as one of the small one. Which elements an
event joins is known from the relationships of the large one (``joined_elements``). Nothing is claimed where a step
depends on a value that elements get from each other, because it may depend on how many there are.
"""

from __future__ import annotations

import time
from itertools import pairwise
from typing import Literal, TypeAlias

from cspdiag.model.program import Program
from cspdiag.network.elaborate.fewer.decisions import are_independent_of_values, only_values_vary
from cspdiag.network.elaborate.fewer.interchangeable import are_interchangeable
from cspdiag.network.elaborate.fewer.joined import Joined, joined_elements
from cspdiag.network.elaborate.fewer.varying import Varying
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.rules.deadlock import is_settled
from cspdiag.proofs.rules.elements import Elements, End, Kind, NoFormError
from cspdiag.proofs.rules.many_loops import all_loops_end, interchangeable_parts, parts_of_elements
from cspdiag.proofs.rules.marked_graph import Place, has_no_circle, order_of_events
from cspdiag.proofs.structure.pairs import Shape, Structure
from cspdiag.proofs.structure.question import StuckQuestion
from cspdiag.proofs.transitions import transition_system
from cspdiag.proofs.transitions.systems.system import Event, System
from cspdiag.proofs.transitions.threads.explore import TransitionError
from cspdiag.proofs.verdict import LimitError, Limits, Proved
from cspdiag.syntax import ast

SECONDS = 2.0
"""Processor time for an order of waiting; what takes longer with few elements is left to the methods for all."""

ManyClaim: TypeAlias = Literal["deadlock free", "livelock free"]


def proved_for_many(
    program: Program, varying: Varying, process: str, claim: ManyClaim, few: CoreNetwork
) -> Proved | None:
    """A proof that a process of many elements has neither a deadlock nor a knot, or no livelock; None if no rule gives
    one.

    ``few`` is the network of the process in the same program with fewer elements, and ``varying`` what varies between
    the two, which have the same neighbourhoods.
    """
    definition = program.definitions[process]
    assert isinstance(definition, ast.ProcessDefinition)
    if definition not in varying.definitions or not are_independent_of_values(program, varying):
        return None
    try:
        system = transition_system(few)
    except TransitionError:
        return None
    if not all(len(event.parties) == 1 or _is_rendezvous(event) for event in system.events):
        return None
    if claim == "livelock free":
        return _by_loops(program, varying, definition, system)
    return _by_marked_graph(program, varying, definition, system) or _by_order(program, varying, system)


def _is_rendezvous(event: Event) -> bool:
    return event.kind == "communication" and len(event.parties) == 2


def _by_marked_graph(
    program: Program, varying: Varying, definition: ast.ProcessDefinition, system: System
) -> Proved | None:
    if not _have_one_form(program, varying, definition):
        return None
    joined = joined_elements(program, definition, varying)
    if joined is None:
        return None
    try:
        places = _Places(system, definition.name.text, joined).found()
    except NoFormError:
        return None
    if not has_no_circle(places):
        return None
    return Proved(
        "rules",
        "every process does its communications over and over in one order, and none waits for itself in a circle of "
        "others: a marked graph, proved once for all elements of each array",
    )


def _have_one_form(program: Program, varying: Varying, definition: ast.ProcessDefinition) -> bool:
    """Whether the processes inside one do the same for any number of elements."""
    return all(only_values_vary(program, varying, other) for other in varying.definitions if other is not definition)


def _by_loops(program: Program, varying: Varying, definition: ast.ProcessDefinition, system: System) -> Proved | None:
    """A proof that every run of hidden events ends."""
    if _have_one_form(program, varying, definition):
        joined = joined_elements(program, definition, varying)
        try:
            elements = None if joined is None else Elements(system, definition.name.text, joined)
            proved = elements is not None and all_loops_end(parts_of_elements(system, elements), elements.place)
        except NoFormError:
            proved = False
    else:
        proved = are_interchangeable(program, varying) and all_loops_end(interchangeable_parts(system))
    if not proved:
        return None
    return Proved(
        "rules",
        "every loop waits for the environment or for time, in at least one process that takes part, proved once for "
        "all elements of each array",
    )


def _by_order(program: Program, varying: Varying, system: System) -> Proved | None:
    """A proof by the order of waiting. How processes wait for each other depends on which of the elements that they
    name are the same, so what holds for interchangeable elements holds for any number of them.
    """
    if not are_interchangeable(program, varying):
        return None
    structure = Structure(system, Limits(SECONDS, clock=time.process_time))
    try:
        if not all(is_settled(StuckQuestion(system, together, structure)) for together in (True, False)):
            return None
    except LimitError:
        return None
    return Proved(
        "rules",
        "no process waits in a circle with others, proved once for all elements of each array, which are "
        "interchangeable",
    )


class _Places:
    """The places without a token of a network of many elements, from its ``system`` with fewer."""

    def __init__(self, system: System, top: str, joined: list[Joined]) -> None:
        self.system = system
        self.structure = Structure(system)
        self.elements = Elements(system, top, joined)

    def found(self) -> list[Place]:
        """The places between events that components do one after the other, the first one after the last one aside.

        Raises NoFormError.
        """
        ends = self._ends()
        found: dict[Place, None] = {}
        for kind, order in self._orders().items():
            shared = [ends[kind, number] for number in order if (kind, number) in ends]
            for before, after in pairwise(shared):
                found.update((self.elements.place(one, other), None) for one in before for other in after)
        return [*found]

    def _orders(self) -> dict[Kind, tuple[int, ...]]:
        """The events of the components of each kind in their order, by their numbers in its shape."""
        orders: dict[Kind, tuple[int, ...]] = {}
        shapes: dict[Kind, Shape] = {}
        structure = self.structure
        parts = zip(self.elements.kinds, structure.shapes, structure.events, self.system.components, strict=True)
        for (kind, _), shape, events, component in parts:
            ends = not any(shape.edges) and shape.terminal.issuperset(range(len(shape.edges)))
            order = () if ends else order_of_events(shape)
            is_alike = shapes.setdefault(kind, shape) is shape
            if order is None or len(order) != len(events) or not is_alike or not component.process:
                raise NoFormError
            orders[kind] = order
        return orders

    def _ends(self) -> dict[tuple[Kind, int], dict[End, None]]:
        """The ends of events that join two components, by the number that they have in the shape of either."""
        found: dict[tuple[Kind, int], dict[End, None]] = {}
        for event, roles in zip(self.system.events, self.structure.roles, strict=True):
            if len(event.parties) == 1 or not roles:
                continue
            if len(roles) != 2:
                raise NoFormError
            numbers, joint = dict(roles), self.elements.joint(event)
            for party in event.parties:
                kind, _ = self.elements.kinds[party]
                end = End(joint, writes=event.role(party) == "!")
                found.setdefault((kind, numbers[party]), {})[end] = None
        return found
