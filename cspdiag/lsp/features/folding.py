"""Folding: blocks in braces, comments of several lines, imports that follow each other."""

from __future__ import annotations

from collections.abc import Iterator

from lsprotocol import types

from cspdiag.base.span import SourceFile
from cspdiag.editing import text_at

_COMMENT = types.FoldingRangeKind.Comment
_IMPORTS = types.FoldingRangeKind.Imports


def folding(source: SourceFile) -> list[types.FoldingRange]:
    """What can be folded."""
    found = text_at.tokens(source, 0, len(source.text))
    ranges = [*_blocks(source, found), *_comments(source, found), *_imports(source)]
    return sorted(ranges, key=lambda each: (each.start_line, -each.end_line))


def _line(source: SourceFile, offset: int) -> int:
    return source.position(offset)[0] - 1


def _blocks(source: SourceFile, found: list[text_at.Token]) -> Iterator[types.FoldingRange]:
    opened: list[int] = []
    for token in found:
        if token.kind == "sign" and token.text == "{":
            opened.append(_line(source, token.start))
        elif token.kind == "sign" and token.text == "}" and opened:
            # The line of the closing brace stays visible.
            start, end = opened.pop(), _line(source, token.start) - 1
            if end > start:
                yield types.FoldingRange(start, end)


def _comments(source: SourceFile, found: list[text_at.Token]) -> Iterator[types.FoldingRange]:
    first = last = -2
    for token in found:
        if token.kind == "comment":
            start, end = _line(source, token.start), _line(source, token.end)
            if start != last + 1 or token.text.startswith("/*"):
                if last > first:
                    yield types.FoldingRange(first, last, kind=_COMMENT)
                first = start
            last = end
        elif last > first:
            yield types.FoldingRange(first, last, kind=_COMMENT)
            first = last = -2
        else:
            first = last = -2
    if last > first:
        yield types.FoldingRange(first, last, kind=_COMMENT)


def _imports(source: SourceFile) -> Iterator[types.FoldingRange]:
    lines = source.text.split("\n")
    start = None
    for number, line in enumerate([*lines, "end"]):
        if line.startswith("import ") and start is None:
            start = number
        elif start is not None and line.strip() and not line.startswith("import "):
            end = number - 1
            while not lines[end].startswith("import "):
                end -= 1
            if end > start:
                yield types.FoldingRange(start, end, kind=_IMPORTS)
            start = None
