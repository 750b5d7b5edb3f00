"""The parser, imported when the first text is parsed: trees that are kept do not need it."""

from __future__ import annotations

from cspdiag.base import Report, SourceFile
from cspdiag.syntax.ast import SourceTree


def parsed(source: SourceFile, report: Report) -> SourceTree:
    """The tree of a file, made from its text."""
    from cspdiag.syntax.parser import parse

    return parse(source, report)
