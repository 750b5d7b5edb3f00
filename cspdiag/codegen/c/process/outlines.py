"""Outlines of the initialization of channels, instances and reading ends: equal outlines make one loop in C, so only
the first elements of large arrays have to be generated.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from typing import TypeAlias, assert_never

from cspdiag.codegen.c.process.struct.members import Members
from cspdiag.codegen.shared.places_in_arrays import Arrays
from cspdiag.codegen.shared.trees import Outline
from cspdiag.model.types import IntType
from cspdiag.network.elaborate.fewer.rows import Repetition, Rows, rows_of
from cspdiag.network.ir.actions import ChannelEnd, End, PortEnd
from cspdiag.network.ir.expressions import Expression, LiteralValue
from cspdiag.network.ir.network import Attachment, Connection, ConstantEnd, CreatedInstance, DiscardEnd, LocalChannel

Created: TypeAlias = CreatedInstance | End
"""What is initialized in the order of creation."""

_Part = tuple[Hashable, tuple[int, ...]]


class Outlines:
    """The outlines of one process class."""

    def __init__(self, members: Members) -> None:
        self._members = members
        self._process = members.process.name
        self._flagged = members.unwritten.variables[self._process]

    def channel(self, channel: LocalChannel) -> Outline:
        """The outline of the initialization of a channel."""
        shape, numbers = self._place(channel.name)
        initial, value = self._value(channel.initial)
        access = self._members.access(ChannelEnd(channel.name))
        kind = (access, channel.kind, channel.name in self._flagged)
        return Outline(("channel", shape, kind, initial), (*numbers, channel.capacity or 0, *value))

    def created(self, item: Created) -> Outline:
        """The outline of the initialization of an instance or a reading end."""
        if isinstance(item, CreatedInstance):
            return self._instance(item.instance)
        shape, numbers = self._attached(item)
        return Outline((type(item).__name__, shape, item.end), numbers)

    def _instance(self, name: str) -> Outline:
        instance = self._members.instances[name]
        shape, numbers = self._place(name)
        shapes: list[Hashable] = ["instance", shape, instance.class_name]
        values = list(numbers)
        by_hand = self._members.classes[instance.class_name].external is not None
        for _, argument in instance.arguments:
            shape, numbers = self._value(argument)
            shapes.append(shape)
            values += numbers
        for connection in instance.connections:
            shape, numbers = self._connection(connection)
            shapes.append(shape)
            values += numbers
            if by_hand and isinstance(connection.attachment, ConstantEnd):
                shapes.append(name)  # it has a variable of its own
        return Outline(tuple(shapes), tuple(values))

    def _connection(self, connection: Connection) -> _Part:
        shape, numbers = self._attached(connection.attachment)
        return (connection.port, connection.index, shape), numbers

    def _attached(self, attachment: Attachment) -> _Part:
        match attachment:
            case ConstantEnd(value=value):
                return self._value(value)
            case ChannelEnd(channel=channel):
                shape, numbers = self._place(channel)
                return ("channel", shape, channel in self._flagged), numbers
            case PortEnd(port=port, index=index) if index is not None and self._members.layout.uniform[port]:
                flagged = self._members.unwritten.has_port(self._process, port, index)
                return ("element", port, index if flagged else None), (index,)
            case PortEnd(port=port, index=index):
                return ("port", port, index), ()
            case DiscardEnd():
                return "nothing", ()
            case _:
                assert_never(attachment)

    def _place(self, name: str) -> _Part:
        array, index = self._members.arrays.place(name)
        return (array, ()) if index is None else ((array, "element"), (index,))

    @staticmethod
    def _value(value: Expression | None) -> _Part:
        match value:
            case LiteralValue(type=IntType(), value=int(number), name=None) if number >= 0:
                return "number", (number,)
        return value, ()


def known_creation(items: Sequence[Created], arrays: Arrays) -> Sequence[Created]:
    """What is created in order, of which that repeats of which the instances do, too: an item has only their names."""
    if not isinstance(items, Rows):
        return items
    return rows_of(items, (part for whole in items.repetitions for part in _known_parts(items, whole, arrays)))


def _known_parts(items: Sequence[Created], whole: Repetition, arrays: Arrays) -> Iterator[Repetition]:
    start, length, left = whole
    while left:
        places = range(start, start + length)
        rounds = 1 if left == 1 else min(left, *(_known_rounds(items, place, length, arrays) for place in places))
        yield Repetition(start, length, rounds)
        start, left = start + rounds * length, left - rounds


def _known_rounds(items: Sequence[Created], place: int, distance: int, arrays: Arrays) -> int:
    """In how many rounds from one on the item in this place of it creates what is known to be alike."""
    item, following = items[place], items[place + distance]
    if not isinstance(item, CreatedInstance) or not isinstance(following, CreatedInstance):
        return len(items)
    array, index = arrays.place(item.instance)
    if index is None or arrays.place(following.instance) != (array, index + 1):
        return 1
    return arrays.known_from(array, index)
