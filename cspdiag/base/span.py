"""Places in source text."""

from __future__ import annotations

import re
from bisect import bisect_right
from functools import cached_property

from cspdiag.base.record import node, record

LINE_END = re.compile(r"\r\n?|\n")
"""What ends a line of a file: a line feed, a carriage return, or both."""


def with_line_feeds(text: str) -> str:
    """The text with each of its lines ended by a line feed."""
    return LINE_END.sub("\n", text) if "\r" in text else text


@node
class SourceFile:
    """The text of one file, under the name that messages show.

    ``name`` is the path as the user gave it (``-`` for standard input, ``std/control.csp`` for the bundled library).
    """

    name: str
    text: str

    def __repr__(self) -> str:
        return f"SourceFile({self.name!r})"

    @cached_property
    def line_starts(self) -> list[int]:
        """Offset of the first character of each line."""
        starts = [0]
        find = self.text.find
        at = find("\n")
        while at >= 0:
            starts.append(at + 1)
            at = find("\n", at + 1)
        return starts

    def position(self, offset: int) -> tuple[int, int]:
        """Line and column of an offset, both counted from 1, the column in characters."""
        line = bisect_right(self.line_starts, offset)
        return line, offset - self.line_starts[line - 1] + 1

    def line_text(self, line: int) -> str:
        """The text of a line counted from 1, without its line end."""
        start = self.line_starts[line - 1]
        end = self.line_starts[line] if line < len(self.line_starts) else len(self.text)
        return self.text[start:end].rstrip("\r\n")


@record
class Span:
    """A half-open range of characters of one file."""

    source: SourceFile
    start: int
    end: int

    @property
    def file(self) -> str:
        """Name of the file, as messages show it."""
        return self.source.name

    @property
    def line(self) -> int:
        """Line of the first character, from 1."""
        return self.source.position(self.start)[0]

    @property
    def column(self) -> int:
        """Column of the first character, from 1."""
        return self.source.position(self.start)[1]

    @property
    def end_line(self) -> int:
        """Line of the end, from 1."""
        return self.source.position(self.end)[0]

    @property
    def end_column(self) -> int:
        """Column just after the last character, from 1."""
        return self.source.position(self.end)[1]

    @property
    def text(self) -> str:
        """The source text of the range."""
        return self.source.text[self.start : self.end]

    def __str__(self) -> str:
        return f"{self.file}:{self.line}"
