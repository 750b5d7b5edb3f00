"""A change of the text that removes what was found."""

from __future__ import annotations

from dataclasses import dataclass

from cspdiag.diagnostics import Span


@dataclass(frozen=True)
class Suggestion:
    """A change that was applied and proved to help: ``words`` say what to do, ``replacement`` is the new text of ``span``."""

    words: str
    span: Span
    replacement: str
