"""The sign ``=`` after what ends a declaration: a default in the wrong place, and no comparison."""

from __future__ import annotations

import re

from cspdiag.base.diagnostic import Edit
from cspdiag.base.span import Span
from cspdiag.syntax.diagnostics.structure import WrongPlace
from cspdiag.syntax.unexpected.situation import Finding, Repair, Situation

_SIGNS = frozenset(["=", ":="])
_NEVER_COMPARED = frozenset(["@", "offset", "safe", "step", "wcet", "wait", "after", "at"])
"""What comes before values that are times, or the last of a declaration."""
_BEFORE_OPERANDS = frozenset(["if", "then", "else", "until", "when", "while", "=", ":=", "!"])
_VALUE = re.compile(
    r"[^\S\n]*(?P<value>(?:[^\n{}@/]|/(?![/*]))+?)(?=\s*(?:@|\bsafe\b|\bin\b|\bout\b|//|/\*|\n|\}|\Z))", re.ASCII
)


def is_comparison(situation: Situation) -> bool:
    """Whether what is before the token may be compared: times are not."""
    for symbol, _ in situation.since_bracket():
        text = situation.text_of(symbol)
        if text in _NEVER_COMPARED or text in _BEFORE_OPERANDS:
            return text in _BEFORE_OPERANDS
    return True


def default_out_of_place(situation: Situation) -> Finding | None:
    """``in x : int @ 10 ms = 1``: the default of a port after its period, or that of an output."""
    if situation.text not in _SIGNS:
        return None
    symbols = dict(reversed(list(situation.since_bracket())))
    text = situation.source.text
    begins = [at for symbol, at in symbols.items() if text.startswith(("@", "safe"), at)]
    if "direction" not in symbols or not begins:
        return None
    match = _VALUE.match(text, situation.lexer.end)
    repair = Repair("remove", end=match.end()) if match else None
    start = min(begins)
    period = text[start : situation.lexer.start].rstrip()
    if text.startswith("out", symbols["direction"]):
        return WrongPlace(situation.span, "a default", "a default belongs to an in port: remove it"), repair
    if any(situation.text_of(symbol) == "=" for symbol in symbols):
        return WrongPlace(situation.span, "a default", "a port has one default, before its period"), repair
    if match is None or not _is_whole(match["value"]) or "\n" in period:
        return WrongPlace(situation.span, "a default", "the default comes before the period"), None
    meant = f"= {match['value']} {period}"
    fix = Edit(Span(situation.source, start, match.end()), meant)
    return WrongPlace(situation.span, "a default", f"the default comes before the period: write `{meant}`", fix), repair


def _is_whole(value: str) -> bool:
    """Whether all brackets of a value are closed in it."""
    return all(value.count(opening) == value.count(closing) for opening, closing in ("()", "[]"))
