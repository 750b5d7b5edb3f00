"""Diagnostics as JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.span import Span


def render(diagnostics: Sequence[Diagnostic]) -> str:
    """A list with an object for each diagnostic; lines and columns count from 1, the end is exclusive."""
    return json.dumps([_object(diagnostic) for diagnostic in diagnostics], indent=2) + "\n"


def place(span: Span | None) -> dict[str, Any]:
    """``file``, ``line`` and ``column``; empty without a place."""
    if span is None:
        return {}
    line, column = span.source.position(span.start)
    return {"file": span.file, "line": line, "column": column}


def _range(span: Span) -> dict[str, Any]:
    return {**place(span), "end_line": span.end_line, "end_column": span.end_column}


def _object(diagnostic: Diagnostic) -> dict[str, Any]:
    words = diagnostic.words
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity,
        "message": words.message,
        **_range(diagnostic.span),
        "help": words.help,
        "related": [{"message": label.message, **place(label.span)} for label in words.labels],
        "edits": [{**_range(edit.span), "replacement": edit.replacement} for edit in diagnostic.edits],
    }
