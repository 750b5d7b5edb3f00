"""The elements of arrays as the components of a system: which of them are alike, and which events join them."""

from __future__ import annotations

import re

from cspdiag.base.record import record
from cspdiag.network.elaborate.fewer.joined import Joined
from cspdiag.proofs.rules.marked_graph import Place
from cspdiag.proofs.transitions.systems.system import Event, System


class NoFormError(Exception):
    """The network is not one that a rule about many elements is about."""


@record
class Kind:
    """The components that are the same part of the elements of an array, or of one instance, of the outermost
    process.
    """

    instance: str
    part: str


@record
class Joint:
    """The events by which the components of one kind write to those of another."""

    channel: str
    writer: Kind
    reader: Kind


@record
class End:
    """An end of such an event."""

    joint: Joint
    writes: bool


class Elements:
    """The components of a ``system`` of few elements, with what is known of many: ``joined`` are the relationships of
    the program with many.
    """

    def __init__(self, system: System, top: str, joined: list[Joined]) -> None:
        self.joined = joined
        self._name = re.compile(rf"{re.escape(top)}\.(\w+)(?:\[(\d+)\])?(?![\w\[])(.*)")
        self._apart: dict[Joint, tuple[int, int] | None] = {}
        self.kinds = [self._kind(component.name) for component in system.components]
        """What each component is, and the index of its element; 0 for a single instance."""

    def _kind(self, name: str) -> tuple[Kind, int]:
        match = self._name.fullmatch(name)
        if match is None:
            return Kind("", name), 0
        instance, index, part = match.groups()
        return Kind(instance, part), int(index or 0)

    def joint(self, event: Event) -> Joint:
        """The joint of a communication of two components. Raises NoFormError."""
        match = self._name.fullmatch(event.channel)
        if {*event.roles} != {"!", "?"} or match is None:
            raise NoFormError
        writer, reader = sorted(event.parties, key=event.role)
        (writes, at), (reads, other) = self.kinds[writer], self.kinds[reader]
        instance, _, port = match.groups()
        joint = Joint(f"{instance}{port}", writes, reads)
        if joint not in self._apart:
            self._apart[joint] = self._distance(joint)
        if self._apart[joint] is None and at != other:
            raise NoFormError
        return joint

    def place(self, before: End, after: End) -> Place:
        """Between two events of one component; the index of an event is that of its writer."""
        here = (0, 0) if before.writes else self._apart[before.joint] or (0, 0)
        there = (0, 0) if after.writes else self._apart[after.joint] or (0, 0)
        return Place(before=before.joint, after=after.joint, least=here[0] - there[1], most=here[1] - there[0])

    def _distance(self, joint: Joint) -> tuple[int, int] | None:
        """By how much the index of the reader is more than that of the writer; None for parts of one element.

        Raises NoFormError.
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
        raise NoFormError
