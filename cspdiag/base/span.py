"""Places in source text."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import deque
from collections.abc import Callable, Sequence
from functools import cached_property
from itertools import repeat
from typing import ClassVar

from cspdiag.base.record import node

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


def _end(span: Span) -> int:
    """The offset after its last character."""
    length: int = span._length  # type: ignore[attr-defined] # What is annotated in the class is a field of a record.
    return span.start + length


class Span:
    """A half-open range of characters of one file.

    Like a record, but smaller: almost every node of a tree has one of its own. Of its end only the distance is kept,
    because Python has every small number once, and the other numbers for each place.
    """

    __slots__ = ("_length", "source", "start")
    __record_fields__: ClassVar = ("source", "start", "end")
    __match_args__ = ("source", "start", "end")

    source: SourceFile
    start: int
    end: int = property(_end)  # type: ignore[assignment]

    def __init__(self, source: SourceFile, start: int, end: int) -> None:
        _set_source(self, source)
        _set_start(self, start)
        _set_length(self, end - start)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"Span.{name} cannot be set: records do not change")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"Span.{name} cannot be deleted: records do not change")

    def __repr__(self) -> str:
        return f"Span(source={self.source!r}, start={self.start!r}, end={self.end!r})"

    def __eq__(self, other: object) -> bool:
        return type(other) is Span and (self.source, self.start, self.end) == (other.source, other.start, other.end)

    def __hash__(self) -> int:
        return hash((self.source, self.start, self.end))

    def __reduce__(self) -> tuple[type[Span], tuple[SourceFile, int, int]]:
        return Span, (self.source, self.start, self.end)

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


_set_source: Callable[[Span, SourceFile], None] = vars(Span)["source"].__set__
_set_start: Callable[[Span, int], None] = vars(Span)["start"].__set__
_set_length: Callable[[Span, int], None] = vars(Span)["_length"].__set__


def move(spans: Sequence[Span], source: SourceFile, by: int) -> None:
    """Give places a new source and move them by a number of characters.

    Only for those who know everything that refers to these places: the parser that reads a changed text again.
    """
    deque(map(_set_source, spans, repeat(source)), maxlen=0)
    if by:
        for span in spans:
            _set_start(span, span.start + by)
