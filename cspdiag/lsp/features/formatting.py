"""Formatting, as by ``cspdiag fmt``: the smallest changes of whole lines."""

from __future__ import annotations

from difflib import SequenceMatcher

from lsprotocol import types

from cspdiag.base.report import Report
from cspdiag.base.sources import FileStyle
from cspdiag.base.span import SourceFile, Span
from cspdiag.lsp.documents import Document
from cspdiag.lsp.positions import Positions
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse


def formatting(
    document: Document, positions: Positions, lines: tuple[int, int] | None = None
) -> list[types.TextEdit] | None:
    """The changes that format a text, or only those in ``lines``, which are counted from 0; None if it has syntax
    errors, which ``cspdiag fmt`` refuses, too.
    """
    report = Report()
    tree = parse(document.source, report)
    if report.has_errors:
        return None
    text = positions.blanks_for(document.style.mark) + format_tree(tree)
    edits = edits_between(document.source, text, positions, document.style)
    if lines is None:
        return edits
    return [edit for edit in edits if edit.range.start.line <= lines[1] and lines[0] <= edit.range.end.line]


def edits_between(source: SourceFile, text: str, positions: Positions, style: FileStyle) -> list[types.TextEdit]:
    """Changes of whole lines that turn a text into another one, in the style of its file."""
    if source.text == text:
        return []
    old, new = source.text.splitlines(keepends=True), text.splitlines(keepends=True)
    offsets = [0]
    for line in old:
        offsets.append(offsets[-1] + len(line))
    found = []
    for tag, start, end, new_start, new_end in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        if tag != "equal":
            span = Span(source, offsets[start], offsets[end])
            lines = "".join(new[new_start:new_end]).replace("\n", style.end)
            if start == 0:
                lines = style.mark + lines.removeprefix(positions.blanks_for(style.mark))
            found.append(types.TextEdit(positions.range(span), lines))
    return found
