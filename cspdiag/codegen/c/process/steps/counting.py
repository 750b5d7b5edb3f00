"""Actions as trees in which names, ends and integers may count: branches or turns that differ in them share code."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, TypeAlias, TypeVar, cast

from cspdiag.base.record import field_names, is_record, record, replaced
from cspdiag.base.span import Span
from cspdiag.codegen.c.process.struct.members import Members, NumberedEnd
from cspdiag.codegen.c.text.media import READING_ENDS
from cspdiag.codegen.c.text.numbered import Numbered
from cspdiag.codegen.shared.trees import Counted, Outline, outline
from cspdiag.model.types import IntType, TimeType, Type
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import LiteralValue, VariableValue
from cspdiag.network.ir.network import ProcessClass
from cspdiag.network.ir.walk import all_actions, parts

T = TypeVar("T")

_LARGE = 1 << 62
"""From here on the difference of two numbers may not fit in an ``int``."""


@record
class Counter:
    """What counts the branches, or the turns of a loop, from ``start`` on, and how many there are."""

    name: str
    count: int
    start: int = 0
    is_turn: bool = True


Counters: TypeAlias = tuple[Counter, ...]
"""What counts the branches, or the turns of each loop around a step, the innermost first."""


@record
class _Counted(Counted):
    """``changes`` are the differences from one branch or turn to the next, by the loops around it, the innermost
    first.
    """

    value: int
    changes: tuple[int, ...]


@record
class _Name(_Counted):
    """An element of an array of channels or instances."""

    array: str


@record
class _End(_Counted):
    """An element of an array of ports."""

    port: str
    end: int


@record
class _Number(_Counted):
    """An integer, or a duration in nanoseconds."""

    type: Type
    span: Span | None


class CountableTree:
    """Actions as trees whose names, ends and integers are nodes that may count."""

    def __init__(self, members: Members, shared: tuple[type, ...]) -> None:
        self._members = members
        self._shared = shared
        """The kinds of steps that may be shared."""
        self._flagged = members.unwritten.variables[members.process.name]

    def outline(self, action: ir.Action) -> Outline | None:
        """The shape of an action and its numbers: branches of the same shape whose numbers count can share their code.
        None if the action cannot share any.
        """
        return outline(self.tree(action)) if self.is_plain(action) else None

    def is_plain(self, action: ir.Action) -> bool:
        """Whether an action can share its code."""
        return all(map(self._is_plain_step, all_actions(action))) and all(map(self._is_plain_part, parts(action)))

    def _is_plain_step(self, step: ir.Action) -> bool:
        if isinstance(step, ir.RunInstance) and ir.RunInstance in self._shared:
            instance = self._members.instances[step.instance]
            return isinstance(self._members.classes[instance.class_name], ProcessClass)
        return isinstance(step, self._shared)

    def _is_plain_part(self, part: object) -> bool:
        members = self._members
        match part:
            case ir.ChannelEnd(channel=channel):
                return not self._is_flagged(channel) and members.access(part) not in READING_ENDS
            case VariableValue(channel=channel) | ir.Target(channel=channel):
                return not self._is_flagged(channel)
            case ir.PortEnd(port=port, index=index):
                return not members.unwritten.has_port(members.process.name, port, index)
            case _:  # Not a part with a flag.
                return True

    def _is_flagged(self, channel: str) -> bool:
        """Whether an element of an array has a flag of its own; that of a single variable is the same for all."""
        return channel in self._flagged and self._members.arrays.place(channel)[1] is not None

    def tree(self, item: Any) -> Any:
        """The same, with nodes that may count."""
        match item:
            case str():
                array, index = self._members.arrays.place(item)
                return item if index is None else _Name(index, (), array)
            case tuple():
                return tuple([self.tree(part) for part in item])
            case ir.PortEnd(port=port, index=int(index), end=end) if self._members.layout.uniform[port]:
                return _End(index, (), port, end)
            case LiteralValue(type=IntType() | TimeType(), value=int(value), name=None) if abs(value) < _LARGE:
                return _Number(value, (), item.type, item.span)
            case _ if is_record(item):
                return replaced(item, **{name: self.tree(getattr(item, name)) for name in fields_inside(item)})
            case _:  # A number, a Boolean or None.
                return item


def counting(item: T, changes: Iterator[int]) -> T:
    """The tree of the first branch or turn, with by how much each number changes from one to the next."""
    found: Any = item
    if isinstance(item, _Counted):
        found = replaced(item, changes=(*item.changes, next(changes)))
    elif isinstance(item, tuple):
        found = tuple([counting(part, changes) for part in item])
    elif is_record(item):
        found = replaced(item, **{name: counting(getattr(item, name), changes) for name in fields_inside(item)})
    return cast("T", found)


def can_count_from(start: int, first: Outline, changes: Sequence[int]) -> bool:
    """Whether all numbers can be computed from a counter that is ``start`` for the first branch."""
    return all(abs(number - change * start) < _LARGE for number, change in zip(first.numbers, changes, strict=True))


class Numbering:
    """Turns trees into actions that all branches, or all turns of loops, can share."""

    def __init__(self, members: Members) -> None:
        self._members = members

    def filled(self, item: Any, counters: Counters) -> Any:
        """The tree with actions in place of the nodes that may count."""
        if isinstance(item, _Counted):
            return self._made(item, [(each, step) for each, step in zip(counters, item.changes, strict=True) if step])
        if isinstance(item, tuple):
            return tuple([self.filled(part, counters) for part in item])
        if is_record(item):
            return replaced(item, **{name: self.filled(getattr(item, name), counters) for name in fields_inside(item)})
        return item

    def _made(self, node: _Counted, counted: Sequence[tuple[Counter, int]]) -> object:
        """The action for a node, with what counts it, and by how much that changes it."""
        products = tuple([(counter.name, step) for counter, step in reversed(counted)])
        number = Numbered(products, node.value - sum(step * counter.start for counter, step in counted))
        match node:
            case _Name(array=array, value=first):
                return (
                    self._members.numbered(array, number, first)
                    if counted
                    else self._members.arrays.element(array, first)
                )
            case _End(port=port, value=first, end=end):
                if not counted:
                    return ir.PortEnd(port, first, end)
                return NumberedEnd(port=port, index=first, end=end, number=number)
            case _Number(type=type_, span=span, value=first):
                if not counted:
                    return LiteralValue(type=type_, span=span, value=first)
                ends = [step * (counter.count - 1) for counter, step in counted]
                limits = (first + sum(min(end, 0) for end in ends), first + sum(max(end, 0) for end in ends))
                return VariableValue(type=type_, span=span, channel=self._members.number(number, type_), range=limits)
            case _:
                raise AssertionError(f"{type(node).__name__} does not count")


def fields_inside(item: object) -> list[str]:
    """The fields of a record in which names, ends or integers may be."""
    return [name for name in field_names(item) if name not in ("span", "type")]
