"""``complete``, ``hover``, ``definition`` and ``format``."""

from __future__ import annotations

from cspdiag.base.report import Report
from cspdiag.base.span import SourceFile
from cspdiag.editing import definition as declared
from cspdiag.editing import hover as known
from cspdiag.editing.completion import Completion
from cspdiag.editing.completion import completion as possible
from cspdiag.editing.positions import position_of
from cspdiag.editing.text_at import word_at
from cspdiag.editing.view import View
from cspdiag.studio.engine.data import Data, place_of
from cspdiag.studio.engine.failure import RequestError


def complete(view: View, offset: int) -> list[Data]:
    """What can be written at an offset, the most probable first, each instead of what is between start and end."""
    source = view.main
    begin = min(word_at(source, offset).start, offset)
    start, end = (position_of(source, at, "utf-16") for at in (begin, offset))
    place = {
        "start": {"line": start[0], "character": start[1]},
        "end": {"line": end[0], "character": end[1]},
    }
    return [{**_item(found), **place} for found in possible(view, offset)]


def _item(found: Completion) -> Data:
    return {
        "label": found.label,
        "kind": found.kind,
        "detail": found.detail,
        "documentation": found.documentation,
        "insert": found.insert,
    }


def hover(view: View, offset: int) -> Data | None:
    """What is known about the name at an offset, as Markdown."""
    found = known.hover(view, offset)
    return None if found is None else {"markdown": found.markdown, "place": place_of(found.span)}


def definition(view: View, offset: int) -> list[Data]:
    """Where the name at an offset is declared."""
    found = declared.definition(view, offset)
    return [] if found is None else [place_of(found)]


def formatted(text: str) -> Data:
    """A text as ``cspdiag fmt`` writes it. Raises RequestError for one with mistakes in its syntax."""
    from cspdiag.syntax.format.formatter import format_tree
    from cspdiag.syntax.parser import parse

    report = Report()
    tree = parse(SourceFile(name="program.csp", text=text), report)
    if report.has_errors:
        raise RequestError("a text with mistakes in its syntax is not formatted", "correct those first")
    return {"text": format_tree(tree)}
