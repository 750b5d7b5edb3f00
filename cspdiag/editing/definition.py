"""Where a name is declared."""

from __future__ import annotations

from cspdiag.base.span import Span
from cspdiag.editing.occurrences import name_place
from cspdiag.editing.view import View
from cspdiag.model.names.imports import file_name
from cspdiag.syntax import ast


def definition(view: View, offset: int) -> Span | None:
    """Where the name at an offset is declared, or the beginning of the file that is imported there."""
    occurrence = view.here.at(offset)
    if occurrence is None:
        return _imported(view, offset)
    place = name_place(occurrence.meaning)
    return place if place is not None and place.file.endswith(".csp") else None


def _imported(view: View, offset: int) -> Span | None:
    for item in view.tree.items:
        if isinstance(item, ast.Import) and item.span.start <= offset <= item.span.end:
            found = view.sources.get(file_name(view.main.name, item))
            if found is not None:
                return Span(found, 0, 0)
    return None
