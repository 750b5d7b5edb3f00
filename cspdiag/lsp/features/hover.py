"""Hover: what a name means, with its type, unit, inferred kind and period."""

from __future__ import annotations

from lsprotocol import types

from cspdiag.lsp import descriptions, text_at
from cspdiag.lsp.positions import Positions
from cspdiag.lsp.view import View


def hover(view: View, offset: int, positions: Positions) -> types.Hover | None:
    """What is known about the name at an offset."""
    occurrence = view.here.at(offset)
    if occurrence is None:
        return _recovered(view, offset, positions)
    found = descriptions.described(view.program, view.facts, occurrence.meaning, occurrence.owner)
    content = types.MarkupContent(types.MarkupKind.Markdown, found.markdown)
    return types.Hover(content, positions.range(occurrence.span))


def _recovered(view: View, offset: int, positions: Positions) -> types.Hover | None:
    """What the tokens say about a name in a definition that could not be read."""
    source = view.tree.source
    word = text_at.word_at(source, offset)
    outlined = text_at.definition_at(source, offset)
    around = text_at.tokens(source, outlined.start if outlined is not None else 0, word.end)
    if not word.text or not around or around[-1].kind != "word":
        return None
    definition = view.program.definitions.get(word.text)
    code = None
    if definition is not None:
        code = descriptions.described(view.program, None, definition, None).markdown
    elif outlined is not None:
        declared = next((each for each in text_at.declared_in(source, outlined) if each.name == word.text), None)
        if declared is not None:
            code = f"```csp\n{text_at.written(declared)}\n```"
    if code is None:
        return None
    return types.Hover(types.MarkupContent(types.MarkupKind.Markdown, code), positions.range(word))
