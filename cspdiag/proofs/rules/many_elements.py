"""Proves once what holds for each of many elements of arrays: networks that are marked graphs, whatever their size.

The components and the events are those of the same program with fewer elements, whose elements have the same
neighbourhoods, so that each component of the large network does the same as one of the small one. Which elements an
event joins is known from the relationships of the large one (``joined_elements``). Nothing is claimed where a step
depends on a value that elements get from each other, because it may depend on how many there are.
"""

from __future__ import annotations

import re
import time
from itertools import pairwise

from cspdiag.base.record import record
from cspdiag.model.program import Program
from cspdiag.network.elaborate.fewer.decisions import are_independent_of_values, only_values_vary
from cspdiag.network.elaborate.fewer.interchangeable import are_interchangeable
from cspdiag.network.elaborate.fewer.joined import Joined, joined_elements
from cspdiag.network.elaborate.fewer.varying import Varying
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.rules.deadlock import is_settled
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


class _NoSuchForm(Exception):  # noqa: N818 - it is no error
    """The network is not one that this rule is about."""


@record
class _Kind:
    """The components that are the same part of the elements of an array, or of one instance, of the outermost
    process.
    """

    instance: str
    part: str


@record
class _Joint:
    """The events by which the components of one kind write to those of another."""

    channel: str
    writer: _Kind
    reader: _Kind


@record
class _End:
    """An end of such an event."""

    joint: _Joint
    writes: bool


def proved_for_many(program: Program, varying: Varying, process: str, few: CoreNetwork) -> Proved | None:
    """A proof that a process of many elements has neither a deadlock nor a knot; None if no rule gives one.

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
    return _by_marked_graph(program, varying, definition, system) or _by_order(program, varying, system)


def _is_rendezvous(event: Event) -> bool:
    return event.kind == "communication" and len(event.parties) == 2


def _by_marked_graph(
    program: Program, varying: Varying, definition: ast.ProcessDefinition, system: System
) -> Proved | None:
    others = (other for other in varying.definitions if other is not definition)
    if not all(only_values_vary(program, varying, other) for other in others):
        return None
    joined = joined_elements(program, definition, varying)
    if joined is None:
        return None
    try:
        places = _Places(system, definition.name.text, joined).found()
    except _NoSuchForm:
        return None
    if not has_no_circle(places):
        return None
    return Proved(
        "rules",
        "every process does its communications over and over in one order, and none waits for itself in a circle of "
        "others: a marked graph, proved once for all elements of each array",
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
        self.joined = joined
        self._name = re.compile(rf"{re.escape(top)}\.(\w+)(?:\[(\d+)\])?(?![\w\[])(.*)")
        self._apart: dict[_Joint, tuple[int, int] | None] = {}
        self._kinds = [self._kind(component.name) for component in system.components]

    def found(self) -> list[Place]:
        """The places between events that components do one after the other, the first one after the last one aside.

        Raises _NoSuchForm.
        """
        joints = self._joints()
        found: dict[Place, None] = {}
        for kind, order in self._orders().items():
            shared = [joints[kind, number] for number in order if (kind, number) in joints]
            for before, after in pairwise(shared):
                found.update((self._place(one, other), None) for one in before for other in after)
        return [*found]

    def _orders(self) -> dict[_Kind, tuple[int, ...]]:
        """The events of the components of each kind in their order, by their numbers in its shape."""
        orders: dict[_Kind, tuple[int, ...]] = {}
        shapes: dict[_Kind, Shape] = {}
        structure = self.structure
        parts = zip(self._kinds, structure.shapes, structure.events, self.system.components, strict=True)
        for (kind, _), shape, events, component in parts:
            ends = not any(shape.edges) and shape.terminal.issuperset(range(len(shape.edges)))
            order = () if ends else order_of_events(shape)
            is_alike = shapes.setdefault(kind, shape) is shape
            if order is None or len(order) != len(events) or not is_alike or not component.process:
                raise _NoSuchForm
            orders[kind] = order
        return orders

    def _kind(self, name: str) -> tuple[_Kind, int]:
        """What a component is, and the index of its element."""
        match = self._name.fullmatch(name)
        if match is None:
            return _Kind("", name), 0
        instance, index, part = match.groups()
        return _Kind(instance, part), int(index or 0)

    def _joints(self) -> dict[tuple[_Kind, int], dict[_End, None]]:
        """The events that join two components, by the number that they have in the shape of either."""
        found: dict[tuple[_Kind, int], dict[_End, None]] = {}
        for event, roles in zip(self.system.events, self.structure.roles, strict=True):
            if len(event.parties) == 1 or not roles:
                continue
            match = self._name.fullmatch(event.channel)
            if len(roles) != 2 or {*event.roles} != {"!", "?"} or match is None:
                raise _NoSuchForm
            numbers = dict(roles)
            writer, reader = sorted(event.parties, key=event.role)
            (writes, at), (reads, other) = self._kinds[writer], self._kinds[reader]
            instance, _, port = match.groups()
            joint = _Joint(f"{instance}{port}", writes, reads)
            if joint not in self._apart:
                self._apart[joint] = self._distance(joint)
            if self._apart[joint] is None and at != other:
                raise _NoSuchForm
            found.setdefault((writes, numbers[writer]), {})[_End(joint, writes=True)] = None
            found.setdefault((reads, numbers[reader]), {})[_End(joint, writes=False)] = None
        return found

    def _place(self, before: _End, after: _End) -> Place:
        """Between two events of one component; the index of an event is that of its writer."""
        here = (0, 0) if before.writes else self._apart[before.joint] or (0, 0)
        there = (0, 0) if after.writes else self._apart[after.joint] or (0, 0)
        return Place(before=before.joint, after=after.joint, least=here[0] - there[1], most=here[1] - there[0])

    def _distance(self, joint: _Joint) -> tuple[int, int] | None:
        """By how much the index of the reader is more than that of the writer; None for parts of one element.

        Raises _NoSuchForm.
        """
        found = [
            each
            for each in self.joined
            if joint.channel == f"{each.source}.{each.output}"
            and (each.source, each.sink) == (joint.writer.instance, joint.reader.instance)
        ]
        if found:
            return min(each.least for each in found), max(each.most for each in found)
        if joint.writer.instance == joint.reader.instance:
            return None
        raise _NoSuchForm
