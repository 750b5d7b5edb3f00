"""The parts of the text around a place, and within a part."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from cspdiag.base import Span
from cspdiag.base.record import field_names, is_record
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


def looks_the_same(part: ast.Node, renamed: Mapping[str, str]) -> bool:
    """Whether a part of the text means the same after some names are exchanged for others; the order of branches of
    alternatives and parallels does not matter.
    """
    return _normalized(part, {}) == _normalized(part, renamed)


def _normalized(part: object, renamed: Mapping[str, str]) -> str:
    if isinstance(part, Span):
        return ""
    if isinstance(part, tuple):
        return f"({' '.join(_normalized(element, renamed) for element in part)})"
    if isinstance(part, ast.Alternative | ast.Parallel) and not part.prioritized:
        inner = part.branches if isinstance(part, ast.Alternative) else part.processes
        return f"{type(part).__name__}{sorted(_normalized(element, renamed) for element in inner)}"
    if isinstance(part, ast.Node):
        return f"{type(part).__name__}({' '.join(_normalized(field, renamed) for field in _fields(part))})"
    return renamed.get(part, part) if isinstance(part, str) else str(part)


def _fields(part: object) -> list[object]:
    assert is_record(part)
    return [getattr(part, name) for name in field_names(part)]
