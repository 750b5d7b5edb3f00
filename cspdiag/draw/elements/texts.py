"""Pieces of the program text as diagrams show them: on one line, without comments, and their places."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable

from cspdiag.base import Span
from cspdiag.syntax import ast

_WORDS = re.compile(r"\w\s+\w")
_OPERATOR = re.compile(r"(?<=[\w\])])([-+*/%])")
_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)


def written(node: ast.Node) -> str:
    """The text of a node."""
    return written_span(node.span)


def written_span(span: Span) -> str:
    """The text at a place."""
    return " ".join(_COMMENT.sub(" ", span.text).split())


def place_in_file(span: Span) -> str:
    """File and line without the folders, which are not the same everywhere."""
    return f"{os.path.basename(span.file)}:{span.line}"


def squeezed(text: str) -> str:
    """The text without spaces, which only separate words."""
    return "".join(text.split())


def same_text(one: str, other: str) -> bool:
    """Whether two pieces of text differ at most in spaces."""
    return squeezed(one) == squeezed(other)


def optional(node: ast.Node | None) -> str | None:
    """The text of a node; None for None."""
    return None if node is None else written(node)


def indexes(expressions: Iterable[ast.Expression]) -> str:
    """``[i + 1][0]``, or nothing; with one space around operators however it was written, because elements are
    identified by it.
    """
    return "".join(f"[{_spaced(written(expression))}]" for expression in expressions)


def _spaced(text: str) -> str:
    return text if _WORDS.search(text) else _OPERATOR.sub(r" \1 ", squeezed(text))


def replicator(item: ast.Replicator) -> str:
    """``i < n``."""
    return f"{item.name.text} < {written(item.count)}"


def parameters(items: Iterable[ast.Parameter]) -> tuple[str, ...]:
    """The texts of parameters, such as ``speed: double<rad/s> = 1<rad/s>``."""
    return tuple(written(item) for item in items)


def arguments(items: Iterable[ast.Argument]) -> tuple[str, ...]:
    """The texts of arguments, such as ``speed = 1<rad/s>``."""
    return tuple(
        written(item.value) if item.name is None else f"{item.name.text} = {written(item.value)}" for item in items
    )


def kind(item: ast.Kind | None) -> tuple[str | None, str | None]:
    """The requested kind and its capacity."""
    return (None, None) if item is None else (item.name, optional(item.capacity))
