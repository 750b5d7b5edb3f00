"""Applies the edits of diagnostics to texts."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from cspdiag.base.diagnostic import Diagnostic, Edit
from cspdiag.base.span import Span
from cspdiag.base.spelling import is_slip

_WORD = re.compile(r"\w", re.ASCII)


def replacing(span: Span, text: str) -> Edit:
    """Replace what is at ``span`` by ``text``, with a space where a word would otherwise join the next one."""
    whole, start, end = span.source.text, span.start, span.end
    before = " " if _WORD.match(text) and _WORD.match(whole, max(0, start - 1), start) else ""
    after = " " if _WORD.match(text[-1:]) and _WORD.match(whole, end) else ""
    return Edit(span, f"{before}{text}{after}")


def slip(span: Span, name: str, meant: str | None) -> tuple[Edit, ...]:
    """Replace the name at ``span`` by ``meant``, if it is certainly a slip."""
    return (Edit(span, meant),) if meant and span.text == name and is_slip(name, meant) else ()


def removing(span: Span) -> Edit:
    """Remove what is at ``span``: with its line, if nothing else is on it, or with the space before it."""
    text, start, end = span.source.text, span.start, span.end
    while start > 0 and text[start - 1] in " \t":
        start -= 1
    rest = re.compile(r"[ \t]*\n").match(text, end)
    if (start == 0 or text[start - 1] == "\n") and rest is not None:
        end = rest.end()
    return Edit(Span(span.source, start, end), "")


def apart(diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
    """The diagnostics with edits; of several whose edits touch each other, only the first."""
    taken: list[Span] = []
    chosen = []
    for diagnostic in diagnostics:
        spans = [edit.span for edit in diagnostic.edits]
        if spans and not any(_touch(span, other) for span in spans for other in taken):
            taken += spans
            chosen.append(diagnostic)
    return chosen


def _touch(one: Span, other: Span) -> bool:
    return one.source is other.source and one.start <= other.end and other.start <= one.end


def applied(text: str, edits: Sequence[Edit]) -> str:
    """The text after changes that do not touch each other."""
    parts, at = [], 0
    for edit in sorted(edits, key=lambda edit: edit.span.start):
        parts += [text[at : edit.span.start], edit.replacement]
        at = edit.span.end
    return "".join([*parts, text[at:]])
