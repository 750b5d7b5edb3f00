"""Offsets in source texts, and positions as editors count them: a line and the number of code units before a place on
that line, both from 0. Which units is agreed at the start.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

from cspdiag.base.span import SourceFile

Encoding: TypeAlias = Literal["utf-8", "utf-16", "utf-32"]
"""The code units that positions count."""

_UNITS = {"utf-8": ("utf-8", 1), "utf-16": ("utf-16-le", 2)}


def units(text: str, encoding: Encoding) -> int:
    """The number of code units of a text."""
    if encoding == "utf-32" or text.isascii():
        return len(text)
    codec, size = _UNITS[encoding]
    return len(text.encode(codec, "surrogatepass")) // size


def _characters(text: str, count: int, encoding: Encoding) -> int:
    """The number of characters in the first ``count`` code units of a text; inside a character, up to before it."""
    if encoding == "utf-32" or text.isascii():
        return min(count, len(text))
    found = 0
    for character in text:
        count -= units(character, encoding)
        if count < 0:
            break
        found += 1
    return found


def position_of(source: SourceFile, offset: int, encoding: Encoding) -> tuple[int, int]:
    """The line and the code units before it of an offset."""
    line, column = source.position(offset)
    start = source.line_starts[line - 1]
    return line - 1, units(source.text[start : start + column - 1], encoding)


def offset_of(source: SourceFile, line: int, character: int, encoding: Encoding) -> int:
    """The offset of a position; what lies behind the end of a line or of the text is that end."""
    if line >= len(source.line_starts):
        return len(source.text)
    return source.line_starts[line] + _characters(source.line_text(line + 1), character, encoding)
