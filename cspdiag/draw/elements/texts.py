"""Pieces of the text as they are written on a diagram: on one line, without comments."""

from __future__ import annotations

import re
from collections.abc import Iterable

from cspdiag.base import Span
from cspdiag.syntax import ast

_WORDS = re.compile(r"\w\s+\w")
_OPERATOR = re.compile(r"(?<=[\w\])])([-+*/%])")
_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)


def written(node: ast.Node) -> str:
    """What the node is in the text."""
    return written_span(node.span)


def written_span(span: Span) -> str:
    """The text at a place."""
    return " ".join(_COMMENT.sub(" ", span.text).split())


def squeezed(text: str) -> str:
    """The text without blanks, which only separate words."""
    return "".join(text.split())


def same_text(one: str, other: str) -> bool:
    """Whether two pieces of text differ in blanks at most."""
    return squeezed(one) == squeezed(other)


def optional(node: ast.Node | None) -> str | None:
    """The same; None for None."""
    return None if node is None else written(node)


def indexes(expressions: Iterable[ast.Expression]) -> str:
    """``[i + 1][0]``, or nothing; with one blank around operators, however it was written, since elements are known by
    it.
    """
    return "".join(f"[{_spaced(written(expression))}]" for expression in expressions)


def _spaced(text: str) -> str:
    return text if _WORDS.search(text) else _OPERATOR.sub(r" \1 ", squeezed(text))


def replicator(item: ast.Replicator) -> str:
    """``i < n``."""
    return f"{item.name.text} < {written(item.count)}"


def parameters(items: Iterable[ast.Parameter]) -> tuple[str, ...]:
    """``speed: double<rad/s> = 1<rad/s>``, one each."""
    return tuple(written(item) for item in items)


def arguments(items: Iterable[ast.Argument]) -> tuple[str, ...]:
    """``speed = 1<rad/s>``, one each."""
    return tuple(
        written(item.value) if item.name is None else f"{item.name.text} = {written(item.value)}" for item in items
    )


def kind(item: ast.Kind | None) -> tuple[str | None, str | None]:
    """The requested kind and its capacity."""
    return (None, None) if item is None else (item.name, optional(item.capacity))
