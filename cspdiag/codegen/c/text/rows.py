"""Lines of C with their depth, before they are indented and broken."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.text.code import INDENT, LINE_LENGTH, statement
from cspdiag.codegen.c.text.documents import comment


@record
class Row:
    """One line: ``depth`` counts from the function's body, labels stand one less deep; ``comment`` stands above it."""

    text: str
    depth: int = 0
    comment: str | None = None


def rows(*texts: str) -> list[Row]:
    """Lines at one depth."""
    return [Row(text) for text in texts]


def deeper(inner: Iterable[Row], by: int = 1) -> list[Row]:
    """The lines inside a block."""
    return [Row(row.text, row.depth + by, row.comment) for row in inner]


def block(head: str, body: Sequence[Row], tail: str = "}") -> list[Row]:
    """``head {``, the body, ``}``."""
    return [Row(f"{head} {{" if head else "{"), *deeper(body), Row(tail)]


def lines(items: Iterable[Row], depth: int = 0) -> list[str]:
    """The lines of a file."""
    result: list[str] = []
    for row in items:
        indent = INDENT * max(row.depth + depth, 0)
        if row.comment is not None:
            result += remark(" ".join(row.comment.split()), indent)
        if not row.text:
            if row.comment is None:
                result.append("")
        elif row.text.startswith("#"):
            result.append(row.text)
        else:
            result += statement("", row.text, "", indent)
    return result


def remark(text: str, indent: str) -> list[str]:
    """A comment on as many lines as it needs."""
    return comment(textwrap.wrap(text, LINE_LENGTH - len(indent) - 6, break_long_words=False) or [""], indent)
