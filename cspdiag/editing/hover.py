"""Hover: what a name means, with its type, unit, inferred kind and period."""

from __future__ import annotations

from cspdiag.base.record import record
from cspdiag.base.span import Span
from cspdiag.editing import descriptions, text_at
from cspdiag.editing.view import View


@record
class Hover:
    """What is known about the name at a place, as Markdown."""

    markdown: str
    span: Span


def hover(view: View, offset: int) -> Hover | None:
    """What is known about the name at an offset."""
    occurrence = view.here.at(offset)
    if occurrence is None:
        return _recovered(view, offset)
    found = descriptions.described(view.program, view.facts, occurrence.meaning, occurrence.owner)
    return Hover(found.markdown, occurrence.span)


def _recovered(view: View, offset: int) -> Hover | None:
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
    return None if code is None else Hover(code, word)
