"""Positions of the Language Server Protocol and offsets in source texts.

A position is a line and the number of code units before it on that line; which units is agreed at the start.
Source texts end their lines with a line feed, whatever the editor uses, so positions are the same in both.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

from lsprotocol import types

from cspdiag.base.span import SourceFile, Span

Encoding: TypeAlias = Literal["utf-8", "utf-16", "utf-32"]
"""The code units that positions count."""

_UNITS = {"utf-8": ("utf-8", 1), "utf-16": ("utf-16-le", 2)}


def _units(text: str, encoding: Encoding) -> int:
    """The number of code units of a text."""
    if encoding == "utf-32" or text.isascii():
        return len(text)
    codec, size = _UNITS[encoding]
    return len(text.encode(codec, "surrogatepass")) // size


def _characters(text: str, units: int, encoding: Encoding) -> int:
    """The number of characters in the first ``units`` code units of a text; inside a character, up to before it."""
    if encoding == "utf-32" or text.isascii():
        return min(units, len(text))
    count = 0
    for character in text:
        units -= _units(character, encoding)
        if units < 0:
            break
        count += 1
    return count


class Positions:
    """Converts between offsets and positions."""

    def __init__(self, encoding: Encoding = "utf-16") -> None:
        self.encoding: Encoding = encoding

    def blanks_for(self, text: str) -> str:
        """As many blanks as a text has code units."""
        return " " * _units(text, self.encoding)

    def position(self, source: SourceFile, offset: int) -> types.Position:
        """The position of an offset."""
        line, column = source.position(offset)
        start = source.line_starts[line - 1]
        return types.Position(line - 1, _units(source.text[start : start + column - 1], self.encoding))

    def range(self, span: Span) -> types.Range:
        """The range of a span."""
        return types.Range(self.position(span.source, span.start), self.position(span.source, span.end))

    def offset(self, source: SourceFile, position: types.Position) -> int:
        """The offset of a position; what lies behind the end of a line or of the text is that end."""
        if position.line >= len(source.line_starts):
            return len(source.text)
        start = source.line_starts[position.line]
        return start + _characters(source.line_text(position.line + 1), position.character, self.encoding)
