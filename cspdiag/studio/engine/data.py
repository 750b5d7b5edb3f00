"""Places, diagnostics and values as plain data."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import TYPE_CHECKING, Any, TypeAlias

from cspdiag.editing.positions import position_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from cspdiag.base.diagnostic import Diagnostic, Edit
    from cspdiag.base.span import Span

Data: TypeAlias = dict[str, Any]
"""An object of JSON."""
Notify: TypeAlias = Callable[[str, Callable[[], Data]], object]
"""Takes what the engine sends without being asked: a method, and what makes its parameters, in any thread."""


def place_of(span: Span) -> Data:
    """A range of a text; lines and UTF-16 code units count from 0."""
    return {"file": span.file, "start": _position(span, span.start), "end": _position(span, span.end)}


def _position(span: Span, offset: int) -> Data:
    line, character = position_of(span.source, offset, "utf-16")
    return {"line": line, "character": character}


def edits_of(edits: Iterable[Edit]) -> list[Data]:
    """Changes of texts."""
    return [{"place": place_of(edit.span), "text": edit.replacement} for edit in edits]


def diagnostic_data(found: Diagnostic) -> Data:
    """A diagnostic with the places that belong to it and its correction."""
    from cspdiag.editing.fixes import title_of

    words = found.words
    return {
        "severity": found.severity,
        "code": found.code,
        "title": found.title,
        "message": words.message,
        "help": words.help,
        "place": place_of(found.span),
        "related": [{"message": label.message, "place": place_of(label.span)} for label in words.labels],
        "fixes": [{"title": title_of(found), "edits": edits_of(found.edits)}] if found.edits else [],
    }


def number(value: Any) -> Any:
    """A part of a value as JSON has it: what is not finite is null."""
    return None if isinstance(value, float) and not isfinite(value) else value


def plain(value: Any) -> Any:
    """A value as JSON has it: structs and arrays as lists."""
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    return number(value)
