"""Diagnostics on one line each, in the form that editors and ``grep`` follow."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.diagnostics.diagnostic import Diagnostic
from cspdiag.diagnostics.snippet import printable


def render(diagnostics: Sequence[Diagnostic]) -> str:
    """``file:line:column: severity[code] message`` for each diagnostic."""
    return "".join(f"{_line(diagnostic)}\n" for diagnostic in diagnostics)


def _line(diagnostic: Diagnostic) -> str:
    span = diagnostic.span
    message = " ".join(printable(diagnostic.message).split("\n"))
    return f"{printable(span.file)}:{span.line}:{span.column}: {diagnostic.severity}[{diagnostic.code}] {message}"
