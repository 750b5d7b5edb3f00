"""Diagnostics, with the other places that belong to them and a link to their manual page."""

from __future__ import annotations

from collections.abc import Callable

from lsprotocol import types
from pygls import uris

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.files.resources import manual_page_file
from cspdiag.base.manual import FAMILIES
from cspdiag.base.span import SourceFile, Span
from cspdiag.lsp.documents import MAX_CHARACTERS, Document
from cspdiag.lsp.positions import Positions

SOURCE = "cspdiag"
UNKNOWN_CHARACTER = "\N{REPLACEMENT CHARACTER}"
"""What editors show in the place of what they cannot read."""


def diagnostic(found: Diagnostic, positions: Positions, uri: Callable[[str], str]) -> types.Diagnostic:
    """A diagnostic as the editor shows it; ``uri`` gives the URI of a source file by name."""
    is_error = found.severity == "error"
    words = found.words
    return types.Diagnostic(
        range=positions.range(found.span),
        message=words.message if words.help is None else f"{words.message}\n{words.help}",
        severity=types.DiagnosticSeverity.Error if is_error else types.DiagnosticSeverity.Warning,
        code=found.code,
        code_description=_manual_page(found.code),
        source=SOURCE,
        related_information=[
            types.DiagnosticRelatedInformation(_location(label.span, positions, uri), label.message)
            for label in words.labels
        ],
    )


def _location(span: Span, positions: Positions, uri: Callable[[str], str]) -> types.Location:
    return types.Location(uri(span.file), positions.range(span))


def _manual_page(code: str) -> types.CodeDescription | None:
    for folder in FAMILIES:
        if folder[:2] == code[1:3]:
            href = uris.from_fs_path(manual_page_file(folder, f"{code}.md"))
            return None if href is None else types.CodeDescription(href)
    return None


def encoding(source: SourceFile, misread: str | None, positions: Positions) -> list[types.Diagnostic]:
    """That the file of a text is not UTF-8 on the disk, or that something in the text could not be read before."""
    at = source.text.find(UNKNOWN_CHARACTER)
    if misread is not None:
        message = f"the file is {misread}\nopen it in the encoding that it has, such as Latin-1, and save it as UTF-8"
        if at >= 0:
            message += f"; saved as it is shown, it loses what has become `{UNKNOWN_CHARACTER}`"
    elif at >= 0:
        message = f"`{UNKNOWN_CHARACTER}` is in the place of something that could not be read"
    else:
        return []
    severity = types.DiagnosticSeverity.Warning if misread is None else types.DiagnosticSeverity.Error
    range_ = positions.range(Span(source, max(at, 0), at + 1))
    return [types.Diagnostic(range=range_, message=message, severity=severity, source=SOURCE)]


def unchecked(document: Document) -> types.Diagnostic:
    """The only diagnostic of a text that is not checked while it is edited."""
    start = types.Position(0, 0)
    return types.Diagnostic(
        range=types.Range(start, start),
        message=f"{too_large(document)}; `cspdiag check` has no such limit",
        severity=types.DiagnosticSeverity.Information,
        source=SOURCE,
    )


def too_large(document: Document) -> str:
    """Why an open file that is too large is not checked, in words."""
    characters = len(document.source.text)
    size = f"{characters} characters, more than the {MAX_CHARACTERS}"
    return f"this file has {size} that are checked while they are edited"
