"""The corrections of diagnostics, as editors offer them."""

from __future__ import annotations

from cspdiag.base.diagnostic import Diagnostic


def title_of(found: Diagnostic) -> str:
    """What the edits of a diagnostic do, in a few words."""
    if len(found.edits) > 1:
        return f"Fix: {found.message}"
    (edit,) = found.edits
    before, after = _shown(edit.span.text), _shown(edit.replacement)
    if not before:
        return f"Insert {after}"
    return f"Replace {before} by {after}" if after else f"Remove {before}"


def _shown(text: str) -> str:
    words = " ".join(text.split())
    return f"`{words if len(words) <= 40 else f'{words[:39]}…'}`" if words else ""
