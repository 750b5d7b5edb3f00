"""Diagnostics on one line each, in the form that editors and ``grep`` follow."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.render.snippet import on_one_line


def render(diagnostics: Sequence[Diagnostic]) -> str:
    """``file:line:column: severity[code] message`` for each diagnostic."""
    return "".join(f"{_line(diagnostic)}\n" for diagnostic in diagnostics)


def _line(diagnostic: Diagnostic) -> str:
    span = diagnostic.span
    message, file = map(on_one_line, (diagnostic.words.message, span.file))
    return f"{file}:{span.line}:{span.column}: {diagnostic.severity}[{diagnostic.code}] {message}"
