"""Hover: what a name means, with its type, unit, inferred kind and period."""

from __future__ import annotations

from lsprotocol import types

from cspdiag.editing.hover import hover as known
from cspdiag.editing.view import View
from cspdiag.lsp.positions import Positions


def hover(view: View, offset: int, positions: Positions) -> types.Hover | None:
    """What is known about the name at an offset."""
    found = known(view, offset)
    if found is None:
        return None
    content = types.MarkupContent(types.MarkupKind.Markdown, found.markdown)
    return types.Hover(content, positions.range(found.span))
