"""Compositions as trees of nodes, and the properties of classes that are looked up often."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TypeAlias

from cspdiag.base import Span
from cspdiag.network.ir.actions import CoreAction, Group, ParallelSteps, PortEnd
from cspdiag.network.ir.network import CoreClass, CoreNetwork, InstanceOf, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import actions_inside, parts

Definition: TypeAlias = "CoreClass | SubmodelClass"


class Node:
    """An action at its position in a composition. Nodes are compared by identity."""

    __slots__ = ("action", "children")

    def __init__(self, action: CoreAction) -> None:
        self.action = action
        self.children: tuple[Node, ...] = tuple(map(Node, _inside(action)))

    @property
    def span(self) -> Span:
        """The place in the text."""
        return self.action.span

    def __repr__(self) -> str:
        return f"<{type(self.action).__name__} {self.action.span}>"


def _inside(action: CoreAction) -> tuple[CoreAction, ...]:
    return tuple(_flat(action)) if isinstance(action, ParallelSteps) else actions_inside(action)


def _flat(action: ParallelSteps[CoreAction]) -> Iterator[CoreAction]:
    """The branches; a branch that is a parallel itself is replaced by its own branches."""
    for step in action.steps:
        inner = step
        while isinstance(inner, Group):
            inner = inner.body
        if isinstance(inner, ParallelSteps):
            yield from _flat(inner)
        else:
            yield step


class Class:
    """A class of the network and what follows from it alone."""

    def __init__(self, definition: Definition) -> None:
        self.definition = definition
        self.name = definition.name
        self.laws: dict[tuple[str, str, tuple[int, ...]], Node] = {}
        """Parallels of the communications of control laws, by instance, side, and positions of the ports."""

    @cached_property
    def body(self) -> Node | None:
        """The composition of a process."""
        if isinstance(self.definition, ProcessClass) and self.definition.body is not None:
            return Node(self.definition.body)
        return None

    @cached_property
    def instances(self) -> dict[str, InstanceOf]:
        """The instances of a process by name."""
        return {i.name: i for i in self.definition.instances} if isinstance(self.definition, ProcessClass) else {}

    @cached_property
    def channels(self) -> dict[str, int]:
        """Positions in ``definition.channels`` by name."""
        if isinstance(self.definition, SubmodelClass):
            return {}
        return {channel.name: position for position, channel in enumerate(self.definition.channels)}

    @cached_property
    def elements(self) -> tuple[tuple[str, int | None], ...]:
        """The ports and elements of arrays of ports, in order."""
        return tuple(
            (port.name, index)
            for port in self.definition.ports
            for index in ((None,) if port.size is None else range(port.size))
        )

    @cached_property
    def uses_of_ports(self) -> dict[PortEnd, int]:
        """How many actions, guards and instances use each end of a port."""
        found: dict[PortEnd, int] = {}
        if isinstance(self.definition, ProcessClass):
            ends = [end for end in parts(self.definition.body) if isinstance(end, PortEnd)]
            for instance in self.definition.instances:
                ends += [c.attachment for c in instance.connections if isinstance(c.attachment, PortEnd)]
            for end in ends:
                found[end] = found.get(end, 0) + 1
        return found

    @cached_property
    def has_parallel(self) -> bool:
        """Whether the composition contains a parallel."""
        return self.body is not None and any(isinstance(part, ParallelSteps) for part in parts(self.body.action))


class Program:
    """The classes of a network by name."""

    def __init__(self, network: CoreNetwork) -> None:
        self.network = network
        self.classes = {definition.name: Class(definition) for definition in network.classes}

    @property
    def top(self) -> Class:
        """The class of the outermost process."""
        return self.classes[self.network.top]
