"""Diagnostics as SARIF 2.1.0 (OASIS, Static Analysis Results Interchange Format), for code scanning."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from cspdiag import __version__
from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.manual import manual_page
from cspdiag.base.span import Span

_SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"


def render(diagnostics: Sequence[Diagnostic]) -> str:
    """One run, with a rule for each kind of diagnostic that was found."""
    kinds = sorted({type(diagnostic) for diagnostic in diagnostics}, key=lambda kind: kind.code)
    index = {kind.code: at for at, kind in enumerate(kinds)}
    driver = {"name": "cspdiag", "version": __version__, "rules": [_rule(kind) for kind in kinds]}
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "results": [_result(diagnostic, index[diagnostic.code]) for diagnostic in diagnostics],
    }
    return json.dumps({"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2) + "\n"


def _rule(kind: type[Diagnostic]) -> dict[str, Any]:
    page = manual_page(kind.code)
    return {
        "id": kind.code,
        "shortDescription": {"text": kind.title},
        "fullDescription": {"text": page.meaning},
        "help": {"text": page.text, "markdown": page.markdown},
        "defaultConfiguration": {"level": kind.severity},
    }


def _result(diagnostic: Diagnostic, rule_index: int) -> dict[str, Any]:
    words = diagnostic.words
    help_line = f"\n{words.help}" if words.help else ""
    result: dict[str, Any] = {
        "ruleId": diagnostic.code,
        "ruleIndex": rule_index,
        "level": diagnostic.severity,
        "message": {"text": words.message + help_line},
        "locations": [_location(diagnostic.span)],
    }
    if words.labels:
        result["relatedLocations"] = [
            {"id": number, "message": {"text": label.message}, **_location(label.span)}
            for number, label in enumerate(words.labels, start=1)
        ]
    if diagnostic.edits:
        result["fixes"] = [_fix(diagnostic)]
    return result


def _fix(diagnostic: Diagnostic) -> dict[str, Any]:
    """The fix: its changes by file, in the order of their places."""
    changed: dict[str, list[dict[str, Any]]] = {}
    for edit in sorted(diagnostic.edits, key=lambda edit: edit.span.start):
        replacement = {"deletedRegion": _region(edit.span), "insertedContent": {"text": edit.replacement}}
        changed.setdefault(_uri(edit.span), []).append(replacement)
    changes = [{"artifactLocation": {"uri": uri}, "replacements": parts} for uri, parts in changed.items()]
    return {"description": {"text": diagnostic.words.help or diagnostic.title}, "artifactChanges": changes}


def _location(span: Span) -> dict[str, Any]:
    return {"physicalLocation": {"artifactLocation": {"uri": _uri(span)}, "region": _region(span)}}


def _uri(span: Span) -> str:
    path = Path(span.file)
    return path.as_uri() if path.is_absolute() else quote(os.fsencode(path.as_posix()))


def _region(span: Span) -> dict[str, int]:
    return {
        "startLine": span.line,
        "startColumn": span.column,
        "endLine": span.end_line,
        "endColumn": span.end_column,
    }
