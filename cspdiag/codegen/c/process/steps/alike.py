"""Branches of an alternative that differ in nothing but their own number: they are written down once.

``alt i < n : request[i] ? question -> reply[i] ! i`` has ``n`` branches in the network, and one body in C, with the
number that was chosen in place of ``i``.
"""

from __future__ import annotations

from typing import Any, assert_never

from cspdiag.base.record import field_names, is_record, record, replaced
from cspdiag.codegen.c.process.struct.members import ChosenEnd, StructMember
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import Code, cast, own
from cspdiag.codegen.c.text.statements import Statement, store
from cspdiag.model.types import IntType
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import LiteralValue, VariableValue
from cspdiag.network.ir.walk import parts

_POINTERS = {"channel": "csp_channel *", "any": "csp_any_channel *", "buffer": "csp_buffer *"}
"""What a chosen element of an array of ports is kept as; other ports are no pointers, or objects of their reader."""

_PLAIN = (ir.SkipStep, ir.ReadValue, ir.WriteValue, ir.AssignValue, ir.WaitStep, ir.SequentialSteps, ir.IfElse)
"""Steps whose states all branches can share."""


class _UnlikeError(Exception):
    """The branches differ in something else."""


@record
class _Found:
    """The body for all, the ends in it that are chosen, and the variable of the number if it stands in values."""

    body: ir.Action
    ends: tuple[ChosenEnd, ...]
    number: str | None


def shared_body(writer: Writer, step: ir.Choice, chosen: Code) -> list[Statement] | None:
    """What all branches do once the number of the ``chosen`` one is known; None where they differ in more than that."""
    try:
        found = _Rolling(writer, step).found()
    except _UnlikeError:
        return None
    setup: list[Statement] = []
    if found.number is not None:
        variable, type_ = writer.members.variable(found.number), IntType()
        setup.append(store(variable, cast(writer.members.types.type_name(type_), chosen)))
    for end in found.ends:
        setup.append(store(own(end.member), own(writer.members.names[end.port]).at(chosen)))
    return [*setup, *writer.statements(found.body)]


class _Rolling:
    def __init__(self, writer: Writer, step: ir.Choice) -> None:
        self.writer = writer
        self.members = writer.members
        self.branches = step.branches
        self.ends: dict[tuple[str, int], ChosenEnd] = {}
        self.number = f"number of {step.name}"
        self.is_numbered = False

    def found(self) -> _Found:
        if not all(map(self._has_plain_guard, self.branches)):
            raise _UnlikeError
        if len({branch.event.target for branch in self.branches if isinstance(branch.event, ir.InputEvent)}) > 1:
            raise _UnlikeError
        if len({type(branch.event) for branch in self.branches}) > 1:
            raise _UnlikeError
        first, second, *others = (branch.body for branch in self.branches)
        if not all(isinstance(part, _PLAIN) for part in parts(first) if isinstance(part, ir.Step)):
            raise _UnlikeError
        _compare(first, second, second, 1)
        for number, body in enumerate(others, 2):
            _compare(first, second, body, number)
        body = self._with_number(first, second)
        for end in self.ends.values():
            self.members.work.append(StructMember(f"{_POINTERS[self.members.access(end)]}{end.member}"))
        if self.is_numbered:
            declaration = f"{self.members.types.type_name(IntType())} {self.members.add_variable(self.number)}"
            self.members.work.append(StructMember(declaration))
        return _Found(body, tuple(self.ends.values()), self.number if self.is_numbered else None)

    def _has_plain_guard(self, branch: ir.Branch) -> bool:
        """Whether its communication leaves nothing to be done for one branch alone."""
        match branch.event:
            case ir.InputEvent(source=source, target=target):
                return not target.indexes and not self.members.source(source).at_once
            case ir.ReadyEvent():
                return True
            case ir.OutputEvent() | ir.AfterEvent() | ir.SkipEvent():
                return False
            case _:
                assert_never(branch.event)

    def _with_number(self, first: Any, second: Any) -> Any:
        """The first body with what was chosen where the second differs from it."""
        if isinstance(first, tuple):
            return tuple([self._with_number(one, other) for one, other in zip(first, second, strict=True)])
        if isinstance(first, ir.PortEnd):
            return first if first.index == second.index else self._chosen_end(first)
        if isinstance(first, LiteralValue):
            return first if first.value == second.value else self._chosen_number(first)
        if not is_record(first):
            return first
        changes = {name: self._with_number(getattr(first, name), getattr(second, name)) for name in _inside(first)}
        return replaced(first, **changes) if changes else first

    def _chosen_end(self, end: ir.PortEnd) -> ChosenEnd:
        if not self.members.layout.uniform[end.port] or self.members.access(end) not in _POINTERS:
            raise _UnlikeError
        key = (end.port, end.end)
        if key not in self.ends:
            member = self.members.names.fresh(f"chosen {end.port}")
            self.ends[key] = ChosenEnd(port=end.port, index=end.index, end=end.end, member=member)
        return self.ends[key]

    def _chosen_number(self, literal: LiteralValue) -> VariableValue:
        if literal.type != IntType():
            raise _UnlikeError
        self.is_numbered = True
        return VariableValue(type=literal.type, span=literal.span, channel=self.number)


def _compare(first: Any, second: Any, other: Any, number: int) -> None:
    """Raise unless all are the same but for indexes and whole numbers that are 0, 1 and ``number``."""
    if type(first) is not type(other):
        raise _UnlikeError
    if isinstance(first, tuple):
        if len(first) != len(other):
            raise _UnlikeError
        for one, next_one, another in zip(first, second, other, strict=True):
            _compare(one, next_one, another, number)
    elif isinstance(first, ir.PortEnd):
        if (first.port, first.end) != (other.port, other.end):
            raise _UnlikeError
        _count(first.index, second.index, other.index, number)
    elif isinstance(first, LiteralValue):
        if first.type != other.type:
            raise _UnlikeError
        _count(first.value, second.value, other.value, number)
    elif is_record(first):
        for name in _inside(first):
            _compare(getattr(first, name), getattr(second, name), getattr(other, name), number)
    elif first != other:
        raise _UnlikeError


def _count(first: object, second: object, other: object, number: int) -> None:
    """Raise unless all are equal, or 0, 1 and ``number``."""
    if type(first) is not type(second) or type(first) is not type(other):
        raise _UnlikeError
    if first == second:
        if first != other:
            raise _UnlikeError
    elif type(first) is not int or (first, second, other) != (0, 1, number):
        raise _UnlikeError


def _inside(item: object) -> tuple[str, ...]:
    return tuple([name for name in field_names(item) if name != "span"])
