"""Diagnostics as workflow commands, which GitHub shows as annotations next to the changed lines."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.render.snippet import printable


def render(diagnostics: Sequence[Diagnostic]) -> str:
    """``::error file=…,line=…::message`` for each diagnostic."""
    return "".join(f"{_command(diagnostic)}\n" for diagnostic in diagnostics)


def _command(diagnostic: Diagnostic) -> str:
    span = diagnostic.span
    properties = {
        "file": span.file,
        "line": str(span.line),
        "endLine": str(span.end_line),
        "col": str(span.column),
        "endColumn": str(span.end_column),
        "title": f"{diagnostic.code}: {diagnostic.title}",
    }
    listed = ",".join(f"{name}={_escape_property(value)}" for name, value in properties.items())
    words = diagnostic.words
    text = words.message + (f"\nhelp: {words.help}" if words.help else "")
    return f"::{diagnostic.severity} {listed}::{_escape(text)}"


def _escape(text: str) -> str:
    return printable(text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A"))


def _escape_property(text: str) -> str:
    return _escape(text).replace(":", "%3A").replace(",", "%2C")
