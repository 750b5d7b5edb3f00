"""Actions as trees in which names, ends and integers may count: branches or turns that differ in them share code."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from cspdiag.base.record import field_names, is_record, record, replaced
from cspdiag.base.span import Span
from cspdiag.codegen.c.process.struct.members import Members, NumberedEnd
from cspdiag.codegen.c.text.media import READING_ENDS
from cspdiag.codegen.c.text.numbered import Numbered
from cspdiag.codegen.shared.trees import Counted, Outline, outline
from cspdiag.model.types import IntType, Type
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import LiteralValue, VariableValue
from cspdiag.network.ir.network import ProcessClass
from cspdiag.network.ir.walk import all_actions, parts

_LARGE = 1 << 62
"""From here on the difference of two numbers may not fit in an ``int``."""


@record
class _Name(Counted):
    """An element of an array of channels or instances."""

    array: str
    value: int


@record
class _End(Counted):
    """An element of an array of ports."""

    port: str
    value: int
    end: int


@record
class _Number(Counted):
    """An integer."""

    type: Type
    span: Span | None
    value: int


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
        plain = all(map(self._is_plain_step, all_actions(action))) and all(map(self._is_plain_part, parts(action)))
        return outline(self.tree(action)) if plain else None

    def _is_plain_step(self, step: ir.Action) -> bool:
        if isinstance(step, ir.RunInstance) and ir.RunInstance in self._shared:
            instance = self._members.instances[step.instance]
            return isinstance(self._members.classes[instance.class_name], ProcessClass)
        return isinstance(step, self._shared)

    def _is_plain_part(self, part: object) -> bool:
        members = self._members
        match part:
            case ir.ChannelEnd(channel=channel):
                return channel not in self._flagged and members.access(part) not in READING_ENDS
            case VariableValue(channel=channel) | ir.Target(channel=channel):
                return channel not in self._flagged
            case ir.PortEnd(port=port, index=index):
                return not members.unwritten.has_port(members.process.name, port, index)
            case _:  # Not a part with a flag.
                return True

    def tree(self, item: Any) -> Any:
        """The same, with nodes that may count."""
        match item:
            case str():
                array, index = self._members.arrays.place(item)
                return item if index is None else _Name(array, index)
            case tuple():
                return tuple([self.tree(part) for part in item])
            case ir.PortEnd(port=port, index=int(index), end=end) if self._members.layout.uniform[port]:
                return _End(port, index, end)
            case LiteralValue(type=IntType(), value=int(value), name=None) if abs(value) < _LARGE:
                return _Number(item.type, item.span, value)
            case _ if is_record(item):
                return replaced(item, **{name: self.tree(getattr(item, name)) for name in _inside(item)})
            case _:  # A number, a Boolean or None.
                return item


class Numbering:
    """Turns the body of the first branch into that of all branches, given by how much each number changes from one
    branch to the next.
    """

    def __init__(self, members: Members, number: str, count: int, changes: Iterator[int]) -> None:
        self._members = members
        self._number = number
        self._count = count
        self._changes = changes

    def filled(self, item: Any) -> Any:
        """The tree with the nodes that may count replaced."""
        if isinstance(item, Counted):
            return self._made(item, next(self._changes))
        if isinstance(item, tuple):
            return tuple([self.filled(part) for part in item])
        if is_record(item):
            return replaced(item, **{name: self.filled(getattr(item, name)) for name in _inside(item)})
        return item

    def _made(self, node: Counted, step: int) -> object:
        match node:
            case _Name(array=array, value=first):
                if not step:
                    return self._members.arrays.element(array, first)
                return self._members.numbered(array, self._numbered(first, step))
            case _End(port=port, value=first, end=end):
                if not step:
                    return ir.PortEnd(port, first, end)
                return NumberedEnd(port=port, index=first, end=end, number=self._numbered(first, step))
            case _Number(type=type_, span=span, value=first):
                if not step:
                    return LiteralValue(type=type_, span=span, value=first)
                name = self._members.number(self._numbered(first, step), type_)
                limits = (first, first + step * (self._count - 1))
                return VariableValue(type=type_, span=span, channel=name, range=limits)
            case _:
                raise AssertionError(f"{type(node).__name__} does not count")

    def _numbered(self, first: int, step: int) -> Numbered:
        return Numbered(self._number, first, step)


def _inside(item: object) -> list[str]:
    return [name for name in field_names(item) if name not in ("span", "type")]
