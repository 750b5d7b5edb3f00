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
_TOKEN = re.compile(
    r'"[^"\n]*"|[^\W\d]\w*'
    r"|(?P<number>(?P<whole>[0-9]+)(?:\.(?P<fraction>[0-9]+))?(?:[eE](?P<exponent>[+-]?[0-9]{1,9})(?![0-9]))?)"
    r"|[0-9]+|\S"
)


def written(node: ast.Node) -> str:
    """The text of a node."""
    return written_span(node.span)


def written_span(span: Span) -> str:
    """The text at a place."""
    return " ".join(_COMMENT.sub(" ", span.text).split())


def place_in_file(span: Span) -> str:
    """File and line without the folders, which are not the same everywhere."""
    return f"{os.path.basename(span.file)}:{span.line}"


def same_text(one: str, other: str) -> bool:
    """Whether two pieces of text differ at most in how they are written."""
    return one == other or meaning(one) == meaning(other)


def meaning(text: str) -> tuple[str, ...]:
    """What has to be equal for two pieces of text to differ only in how they are written: in spaces, and in digits of
    numbers that change no value, as in ``1.50`` and ``1.5``.
    """
    return tuple(_value(token) if token["number"] else token[0] for token in _TOKEN.finditer(text))


def _value(number: re.Match[str]) -> str:
    """A number without digits that change no value; one with a decimal point or an exponent remains one of these."""
    whole, fraction, exponent = number["whole"], number["fraction"] or "", number["exponent"]
    if not fraction and exponent is None:
        return whole.lstrip("0") or "0"
    digits = f"{whole}{fraction}".lstrip("0")
    significant = digits.rstrip("0")
    power = int(exponent or 0) - len(fraction) + len(digits) - len(significant)
    return f"{significant}e{power}" if significant else "0e0"


def optional(node: ast.Node | None) -> str | None:
    """The text of a node; None for None."""
    return None if node is None else written(node)


def indexes(expressions: Iterable[ast.Expression]) -> str:
    """``[i + 1][0]``, or nothing."""
    return "".join(f"[{spaced(written(expression))}]" for expression in expressions)


def spaced(text: str) -> str:
    """The text with one space around operators however it was written, because elements are identified by it."""
    return text if _WORDS.search(text) else _OPERATOR.sub(r" \1 ", "".join(text.split()))


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
