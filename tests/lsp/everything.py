"""Everything that an editor can ask about a place, without a connection."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

from cspdiag.base.span import SourceFile
from cspdiag.editing.text_at import tokens
from cspdiag.lsp.documents import Document
from cspdiag.lsp.features import (
    actions,
    completion,
    diagnostics,
    folding,
    formatting,
    highlighting,
    hints,
    hover,
    lenses,
    navigation,
    outline,
    rename,
    signature,
)
from cspdiag.lsp.session import Session


def ask(session: Session, document: Document, offset: int) -> dict[str, object]:
    """The answer of each feature at an offset of an open document."""
    view = session.view(document)
    documents, positions = session.documents, session.positions
    size = len(document.source.text)
    found: dict[str, object] = {
        "diagnostics": [diagnostics.diagnostic(each, positions, documents.uri) for each in view.diagnostics],
        "hover": hover.hover(view, offset, positions),
        "completion": completion.completion(view, offset),
        "signature": signature.signature(view, offset),
        "outline": outline.outline(view, positions),
        "definition": navigation.definition(view, offset, documents),
        "highlights": navigation.highlights(view, offset, positions),
        "actions": actions.actions(view, offset, offset, (), documents, document.uri),
        "formatting": formatting.formatting(document, positions),
        "folding": folding.folding(document.source),
        "tokens": highlighting.semantic_tokens(view, positions),
        "hints": hints.hints(view, 0, size, positions),
        "lenses": lenses.lenses(view, document.uri, positions),
    }
    with suppress(rename.RenameError):
        found["renamed"] = rename.renamed_at(view, offset).span
    occurrence = view.here.at(offset)
    declaration = None if occurrence is None else navigation.key(occurrence.meaning)
    if declaration is not None:
        found["references"] = navigation.references([view], declaration, documents, declared=True)
    return found


def without_each_token(source: SourceFile) -> Iterator[tuple[str, int]]:
    """The text without one of its tokens, and where that was."""
    text = source.text
    for token in tokens(source, 0, len(text)):
        if token.kind != "comment":
            yield text[: token.start] + text[token.end :], token.start
