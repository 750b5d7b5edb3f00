"""Comments of generated C."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from cspdiag.codegen.c.text.code import LINE_LENGTH
from cspdiag.codegen.c.text.literals import in_comment
from cspdiag.model.sampling import Sampling
from cspdiag.model.types import TIME, ArrayType, RealType, Type
from cspdiag.model.units import DIMENSIONLESS


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


def value_remark(doc: str, type_: Type, sampling: Sampling | None = None) -> str | None:
    """What a value means, its unit, and when it is sampled, as far as the program says so; None if it does not."""
    facts = [f"in {unit}"] if (unit := _unit(type_)) else []
    facts += [sampling.every] if sampling is not None else []
    about, facts_shown = " ".join(doc.split()), ", ".join(facts)
    if not facts:
        return about or None
    if not about:
        return f"{facts_shown[0].upper()}{facts_shown[1:]}."
    if "." in about.removesuffix("."):  # Several sentences; theirs is another one.
        ending = about if about.endswith((".", "!", "?")) else f"{about}."
        return f"{ending} {facts_shown[0].upper()}{facts_shown[1:]}."
    return f"{about.removesuffix('.')}, {facts_shown}."


def _unit(type_: Type) -> str:
    if isinstance(type_, ArrayType):
        return _unit(type_.element)
    if isinstance(type_, RealType):
        return "" if type_.unit == DIMENSIONLESS else str(type_.unit)
    return "nanoseconds" if type_ == TIME else ""


def comment(rows: Sequence[str], indent: str = "") -> list[str]:
    """A comment of several lines."""
    first, *rest = map(in_comment, rows)
    if not rest:
        return [f"{indent}/* {first} */"]
    return [f"{indent}/* {first}", *(f"{indent} * {row}".rstrip() for row in rest), f"{indent} */"]
