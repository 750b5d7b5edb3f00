"""Where a name is declared and used."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from lsprotocol import types

from cspdiag.editing.definition import definition as declaration_of
from cspdiag.editing.occurrences import Meaning, Occurrence, name_place
from cspdiag.editing.view import View
from cspdiag.lsp.documents import Documents, identity
from cspdiag.lsp.positions import Positions

Key = tuple[str, int]
"""A declaration: the identity of its file and the offset of its name. It is the same in all programs."""


def key(meaning: Meaning) -> Key | None:
    """The declaration of a name; None for parts of the language."""
    place = name_place(meaning)
    return None if place is None else (identity(place.file), place.start)


def definition(view: View, offset: int, documents: Documents) -> types.Location | None:
    """Where the name at an offset is declared, or the file that is imported there."""
    place = declaration_of(view, offset)
    return None if place is None else types.Location(documents.uri(place.file), documents.positions.range(place))


def uses(views: Iterable[View], declaration: Key) -> Iterator[Occurrence]:
    """The occurrences of a declaration in some programs, each place once, the declaration itself included."""
    seen = set()
    for view in views:
        for name in view.sources:
            for occurrence in view.occurrences(name):
                if key(occurrence.meaning) == declaration:
                    place = identity(name), occurrence.span.start
                    if place not in seen:
                        seen.add(place)
                        yield occurrence


def references(
    views: Iterable[View], declaration: Key, documents: Documents, *, declared: bool
) -> list[types.Location]:
    """All places of a declaration; with ``declared`` also where it is."""
    return [
        types.Location(documents.uri(each.span.file), documents.positions.range(each.span))
        for each in uses(views, declaration)
        if declared or not each.is_declaration
    ]


def highlights(view: View, offset: int, positions: Positions) -> list[types.DocumentHighlight]:
    """The places in the main file of the name at an offset."""
    spans = [occurrence.span for occurrence in same_in_file(view, offset)]
    return [types.DocumentHighlight(positions.range(span), types.DocumentHighlightKind.Text) for span in spans]


def same_in_file(view: View, offset: int) -> list[Occurrence]:
    """The occurrences in the main file with the same meaning as the one at an offset."""
    occurrence = view.here.at(offset)
    declaration = None if occurrence is None else key(occurrence.meaning)
    if declaration is None:
        return []
    return [each for each in view.here if key(each.meaning) == declaration]
