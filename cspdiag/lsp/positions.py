"""Positions of the Language Server Protocol and offsets in source texts.

Source texts end their lines with a line feed, whatever the editor uses, so positions are the same in both.
"""

from __future__ import annotations

from lsprotocol import types

from cspdiag.base.span import SourceFile, Span
from cspdiag.editing.positions import Encoding, offset_of, position_of, units


class Positions:
    """Converts between offsets and positions."""

    def __init__(self, encoding: Encoding = "utf-16") -> None:
        self.encoding: Encoding = encoding

    def blanks_for(self, text: str) -> str:
        """As many blanks as a text has code units."""
        return " " * units(text, self.encoding)

    def position(self, source: SourceFile, offset: int) -> types.Position:
        """The position of an offset."""
        return types.Position(*position_of(source, offset, self.encoding))

    def range(self, span: Span) -> types.Range:
        """The range of a span."""
        return types.Range(self.position(span.source, span.start), self.position(span.source, span.end))

    def offset(self, source: SourceFile, position: types.Position) -> int:
        """The offset of a position; what lies behind the end of a line or of the text is that end."""
        return offset_of(source, position.line, position.character, self.encoding)
