"""What of the text stands around a place."""

from __future__ import annotations

from typing import TypeVar

from cspdiag.diagnostics import Span
from cspdiag.diagnostics.record import field_names, is_record
from cspdiag.model.program import Program
from cspdiag.syntax import ast

Part = TypeVar("Part", bound=ast.Node)


def covers(outer: Span, inner: Span) -> bool:
    """Whether one place lies within another."""
    return outer.source is inner.source and outer.start <= inner.start and inner.end <= outer.end


def around(program: Program, place: Span, kind: type[Part]) -> list[Part]:
    """The parts of the text of a kind that a place lies in, the innermost first."""
    found: list[Part] = []
    pending: list[object] = [tree.items for tree in program.trees if tree.source is place.source]
    while pending:
        part = pending.pop()
        if isinstance(part, tuple):
            pending += part
        elif isinstance(part, ast.Node) and covers(part.span, place):
            if isinstance(part, kind):
                found.append(part)
            pending += _fields(part)
    return sorted(found, key=lambda part: part.span.end - part.span.start)


def within(whole: object, kind: type[Part]) -> list[Part]:
    """The parts of a kind inside a part of the text, or that part itself, in the order of the text."""
    found: list[Part] = []
    pending = [whole]
    while pending:
        part = pending.pop()
        if isinstance(part, tuple):
            pending += part
        elif isinstance(part, kind):
            found.append(part)
        elif isinstance(part, ast.Node):
            pending += _fields(part)
    return sorted(found, key=lambda part: part.span.start)


def _fields(part: object) -> list[object]:
    assert is_record(part)
    return [getattr(part, name) for name in field_names(part)]
