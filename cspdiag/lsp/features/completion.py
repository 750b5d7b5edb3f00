"""Completion: the words of the language that can follow, and the names that mean something there."""

from __future__ import annotations

from lsprotocol import types

from cspdiag.editing.completion import Completion
from cspdiag.editing.completion import completion as possible
from cspdiag.editing.view import View


def completion(view: View, offset: int) -> list[types.CompletionItem]:
    """What can be written at an offset."""
    return [_item(position, found) for position, found in enumerate(possible(view, offset))]


def _item(position: int, found: Completion) -> types.CompletionItem:
    doc = found.documentation
    return types.CompletionItem(
        found.label,
        kind=types.CompletionItemKind[found.kind.title().replace(" ", "")],
        detail=found.detail,
        documentation=None if doc is None else types.MarkupContent(types.MarkupKind.Markdown, doc),
        insert_text=found.insert,
        # Editors would sort by name.
        sort_text=f"{position:04}",
    )
