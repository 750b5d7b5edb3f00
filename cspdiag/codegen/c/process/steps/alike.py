"""Branches of an alternative that differ only in their number: they share one body in C.

``alt i < n : request[i] ? question -> reply[i] ! i`` has ``n`` branches in the network, and one body in C, with the
number of the chosen branch in place of ``i``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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

_POINTERS = {
    "channel": "csp_channel *",
    "guarded": "csp_guarded_channel *",
    "any": "csp_any_channel *",
    "buffer": "csp_buffer *",
}
"""The declaration of a pointer to the chosen element of an array of ports; other kinds of ports cannot be shared."""

_PLAIN = (ir.SkipStep, ir.ReadValue, ir.WriteValue, ir.AssignValue, ir.WaitStep, ir.SequentialSteps, ir.IfElse)
"""Steps whose states can be shared by all branches."""


class _DifferentError(Exception):
    """The branches differ in more than their number."""


@record
class _SharedBody:
    """The body of all branches, the chosen ends in it, and the variable for the number if values in it need one."""

    body: ir.Action
    ends: tuple[ChosenEnd, ...]
    number: str | None


def shared_body(writer: Writer, step: ir.Choice, start: int, end: int, chosen: Code) -> list[Statement] | None:
    """The body that the branches from ``start`` to before ``end`` share, with ``chosen`` as the number of the branch;
    None if they differ in more than that.
    """
    try:
        shared = _BodySharing(writer, step, start, end).shared_body()
    except _DifferentError:
        return None
    setup: list[Statement] = []
    if shared.number is not None:
        variable, type_ = writer.members.variable(shared.number), IntType()
        setup.append(store(variable, cast(writer.members.types.type_name(type_), chosen)))
    for element in shared.ends:
        setup.append(store(own(element.member), own(writer.members.names[element.port]).at(chosen)))
    return [*setup, *writer.statements(shared.body)]


def runs(branches: Sequence[ir.Branch]) -> Iterator[tuple[int, int]]:
    """All branches in order, as the first and the end of each run whose bodies seem to differ only in their number."""
    start = 0
    while start < len(branches):
        end = start + 1
        while end < len(branches) and _is_next(branches, start, end):
            end += 1
        yield start, end
        start = end


def _is_next(branches: Sequence[ir.Branch], start: int, number: int) -> bool:
    """Whether a branch differs only in its number from those from ``start`` on."""
    first, second, other = branches[start], branches[start + 1], branches[number]
    if type(first.event) is not type(other.event):
        return False
    targets = {branch.event.target for branch in (first, other) if isinstance(branch.event, ir.InputEvent)}
    if len(targets) > 1:
        return False
    try:
        _require_similar(first.body, second.body, other.body, start, number)
    except _DifferentError:
        return False
    return True


class _BodySharing:
    """The body that the branches from ``start`` to before ``end`` share."""

    def __init__(self, writer: Writer, step: ir.Choice, start: int, end: int) -> None:
        self.writer = writer
        self.members = writer.members
        self.branches = step.branches[start:end]
        self.ends: dict[tuple[str, int], ChosenEnd] = {}
        self.number = f"number of {step.name}{f' from {start}' if start else ''}"
        self.is_numbered = False

    def shared_body(self) -> _SharedBody:
        if not all(map(self._has_plain_guard, self.branches)):
            raise _DifferentError
        first, second = self.branches[0].body, self.branches[1].body
        if not all(isinstance(part, _PLAIN) for part in parts(first) if isinstance(part, ir.Step)):
            raise _DifferentError
        body = self._with_number(first, second)
        for end in self.ends.values():
            self.members.work.append(StructMember(f"{_POINTERS[self.members.access(end)]}{end.member}"))
        if self.is_numbered:
            declaration = f"{self.members.types.type_name(IntType())} {self.members.add_variable(self.number)}"
            self.members.work.append(StructMember(declaration))
        return _SharedBody(body, tuple(self.ends.values()), self.number if self.is_numbered else None)

    def _has_plain_guard(self, branch: ir.Branch) -> bool:
        """Whether the guard of a branch needs no statements of its own at the beginning of the branch."""
        match branch.event:
            case ir.InputEvent(source=source, target=target):
                return not target.indexes and not self.members.source(source).never_waits
            case ir.ReadyEvent():
                return True
            case ir.OutputEvent() | ir.AfterEvent() | ir.SkipEvent():
                return False
            case _:
                assert_never(branch.event)

    def _with_number(self, first: Any, second: Any) -> Any:
        """The first body, with the chosen number or end wherever the second differs from it."""
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
            raise _DifferentError
        key = (end.port, end.end)
        if key not in self.ends:
            member = self.members.names.fresh(f"chosen {end.port}")
            self.ends[key] = ChosenEnd(port=end.port, index=end.index, end=end.end, member=member)
        return self.ends[key]

    def _chosen_number(self, literal: LiteralValue) -> VariableValue:
        if literal.type != IntType():
            raise _DifferentError
        self.is_numbered = True
        return VariableValue(type=literal.type, span=literal.span, channel=self.number)


def _require_similar(first: Any, second: Any, other: Any, start: int, number: int) -> None:
    """Raises unless all are equal except for indexes and integers that are ``start``, ``start + 1`` and ``number``."""
    if type(first) is not type(other):
        raise _DifferentError
    if isinstance(first, tuple):
        if len(first) != len(other) or len(first) != len(second):
            raise _DifferentError
        for one, next_one, another in zip(first, second, other, strict=True):
            _require_similar(one, next_one, another, start, number)
    elif isinstance(first, ir.PortEnd):
        if (first.port, first.end) != (other.port, other.end):
            raise _DifferentError
        _require_counting(first.index, second.index, other.index, start, number)
    elif isinstance(first, LiteralValue):
        if first.type != other.type:
            raise _DifferentError
        _require_counting(first.value, second.value, other.value, start, number)
    elif is_record(first):
        if type(first) is not type(second):
            raise _DifferentError
        for name in _inside(first):
            _require_similar(getattr(first, name), getattr(second, name), getattr(other, name), start, number)
    elif first != other:
        raise _DifferentError


def _require_counting(first: object, second: object, other: object, start: int, number: int) -> None:
    """Raises unless all are equal, or ``start``, ``start + 1`` and ``number``."""
    if type(first) is not type(second) or type(first) is not type(other):
        raise _DifferentError
    if first == second:
        if first != other:
            raise _DifferentError
    elif type(first) is not int or (first, second, other) != (start, start + 1, number):
        raise _DifferentError


def _inside(item: object) -> tuple[str, ...]:
    return tuple([name for name in field_names(item) if name != "span"])
