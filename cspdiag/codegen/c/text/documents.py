"""Comments of generated C."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from cspdiag.codegen.c.text.code import LINE_LENGTH
from cspdiag.codegen.c.text.literals import in_comment


def wrapped(doc: str) -> list[str]:
    """The lines of a doc comment, in paragraphs."""
    rows: list[str] = []
    for part in doc.strip().split("\n\n"):
        text = " ".join(part.split())
        rows += [""] if rows else []
        rows += textwrap.wrap(text, LINE_LENGTH - 4, break_long_words=False, break_on_hyphens=False)
    if rows and rows[0] and rows[-1][-1:] not in ".!?:":
        rows[-1] += "."
    return rows


def comment(rows: Sequence[str], indent: str = "") -> list[str]:
    """A comment of several lines."""
    first, *rest = map(in_comment, rows)
    if not rest:
        return [f"{indent}/* {first} */"]
    return [f"{indent}/* {first}", *(f"{indent} * {row}".rstrip() for row in rest), f"{indent} */"]
