"""Comments of generated C."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from cspdiag.codegen.c.code import LINE_LENGTH


def wrapped(doc: str) -> list[str]:
    """The lines of a doc comment, in paragraphs."""
    rows: list[str] = []
    for part in doc.strip().split("\n\n"):
        text = " ".join(part.split()).replace("*/", "* /").replace("/*", "/ *")
        rows += [""] if rows else []
        rows += textwrap.wrap(text, LINE_LENGTH - 4, break_long_words=False, break_on_hyphens=False)
    if rows and rows[0] and rows[-1][-1:] not in ".!?:":
        rows[-1] += "."
    return rows


def comment(rows: Sequence[str], indent: str = "") -> list[str]:
    """A comment of several lines."""
    if len(rows) == 1:
        return [f"{indent}/* {rows[0]} */"]
    first, *rest = rows
    return [f"{indent}/* {first}", *(f"{indent} * {row}".rstrip() for row in rest), f"{indent} */"]
