"""Source lines with marks under them.

A snippet shows the lines of one file that a diagnostic points at. A mark within one line is an underline with its words
after it; a mark over several lines is a bracket in the margin. Columns are terminal cells: tabs are expanded, wide
characters take two, and control characters are shown as pictures, so that no source text can steer the terminal.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Literal

from cspdiag.base.record import record
from cspdiag.base.span import SourceFile, Span

TAB_WIDTH = 4
MAXIMUM_WIDTH = 160
"""Cells of a source line that are shown; of a longer one the part around the marks."""
SHOWN_AT_END = 2
"""Lines shown at either end of a long range of lines."""

Role = Literal["primary", "secondary", "frame", "plain"]
Paint = Callable[[str, Role], str]


@record
class Mark:
    """A range to be marked, with the words next to it; the primary one is where the diagnostic is."""

    span: Span
    message: str
    primary: bool

    @property
    def role(self) -> Role:
        """Which colour it is drawn in."""
        return "primary" if self.primary else "secondary"

    @property
    def stroke(self) -> str:
        """The character it is drawn with."""
        return "^" if self.primary else "-"

    @property
    def lines(self) -> tuple[int, int]:
        """Its first and its last line. A range that ends just after a line end does not reach into the next line."""
        first, last = self.span.line, self.span.end_line
        return (first, last - 1) if last > first and self.span.end_column == 1 else (first, last)


def printable(text: str) -> str:
    """``text`` with every control character but the line end replaced by its picture."""
    if text.isprintable():
        return text
    return "".join(_picture(character) for character in text)


def on_one_line(text: object) -> str:
    """``text``, such as the name of a file, with every control character replaced by its picture, the line end too."""
    return printable(str(text)).replace("\n", "\u240a")


def _picture(character: str) -> str:
    code = ord(character)
    if character == "\n" or character.isprintable():
        return character
    if code < 0x20:
        return chr(0x2400 + code)
    return "\u2421" if code == 0x7F else "\ufffd"


def _cells(line: str) -> tuple[list[str], list[int]]:
    """What is shown for each character of a line, and the cell at which it and, lastly, the end of the line begins."""
    if line.isascii() and line.isprintable():
        return list(line), list(range(len(line) + 1))
    from unicodedata import combining, east_asian_width

    shown: list[str] = []
    offsets: list[int] = [0]
    for character in line:
        if character == "\t":
            width = TAB_WIDTH - offsets[-1] % TAB_WIDTH
            shown.append(" " * width)
        else:
            shown.append(_picture(character))
            width = 0 if combining(character) else 2 if east_asian_width(character) in "WF" else 1
        offsets.append(offsets[-1] + width)
    return shown, offsets


@record
class _Row:
    """A mark within the line at hand: cells ``start`` to ``end``, at least one."""

    start: int
    end: int
    mark: Mark


class _Line:
    """A source line as it is shown, with the cells of the marks within it; of a long line a window around them."""

    def __init__(self, source: SourceFile, number: int, marks: Sequence[Mark]) -> None:
        shown, offsets = _cells(source.line_text(number))
        first, last = 0, len(shown)
        if offsets[-1] > MAXIMUM_WIDTH:
            begin = min((offsets[min(mark.span.column - 1, last)] for mark in marks), default=0)
            first = bisect_left(offsets, begin - MAXIMUM_WIDTH // 4)
            last = bisect_left(offsets, offsets[first] + MAXIMUM_WIDTH, hi=last)
        before = "..." if first else ""
        self.number = number
        self.text = before + "".join(shown[first:last]) + ("..." if last < len(shown) else "")
        self._offsets = offsets
        self._window = first, last
        self._shift = offsets[first] - len(before)
        self.rows = sorted((self._row(mark) for mark in marks), key=lambda row: (row.start, row.end))

    def cell(self, column: int) -> int:
        """The cell of a column counted from 1, within the window."""
        first, last = self._window
        return self._offsets[min(max(column - 1, first), last)] - self._shift

    def _row(self, mark: Mark) -> _Row:
        start = self.cell(mark.span.column)
        end = self.end_cell(mark)
        return _Row(start, max(end, start + 1), mark)

    def end_cell(self, mark: Mark) -> int:
        """The cell after the end of a mark that ends in this line or just after its line end."""
        return self.cell(mark.span.end_column if mark.span.end_line == self.number else len(self._offsets))


def _underlines(line: _Line, paint: Paint) -> list[str]:
    """The rows below a line: strokes with the last mark's words after them, then the other words, each hung on
    a bar.
    """
    rows = line.rows
    cells: list[tuple[str, Role]] = [(" ", "plain")] * max(row.end for row in rows)
    for row in sorted(rows, key=lambda row: row.mark.primary):
        cells[row.start : row.end] = [(row.mark.stroke, row.mark.role)] * (row.end - row.start)
    last = max(rows, key=lambda row: (row.end, row.start))
    beside = last if all(row.end <= last.start or row is last or not row.mark.message for row in rows) else None
    first = _painted(cells, paint)
    if beside is not None and beside.mark.message:
        first += " " + paint(beside.mark.message, beside.mark.role)
    hung = [row for row in rows if row is not beside and row.mark.message]
    below = [first]
    while hung:
        row = hung.pop()
        bars = {other.start: other for other in hung}
        below.append(_bars({**bars, row.start: row}, paint))
        before = {start: other for start, other in bars.items() if start < row.start}
        words = paint(row.mark.message, row.mark.role)
        below.append(_bars(before, paint, upto=row.start) + words)
    return below


def _painted(cells: Sequence[tuple[str, Role]], paint: Paint) -> str:
    parts: list[str] = []
    at = 0
    while at < len(cells):
        role = cells[at][1]
        end = at
        while end < len(cells) and cells[end][1] == role:
            end += 1
        parts.append(paint("".join(character for character, _ in cells[at:end]), role))
        at = end
    return "".join(parts)


def _bars(marks: dict[int, _Row], paint: Paint, upto: int | None = None) -> str:
    length = (max(marks, default=-1) + 1) if upto is None else upto
    cells: list[tuple[str, Role]] = [(" ", "plain")] * length
    for start, row in marks.items():
        cells[start] = ("|", row.mark.role)
    return _painted(cells, paint)


def _visible_lines(marks: Sequence[Mark]) -> list[int]:
    wanted: set[int] = set()
    for mark in marks:
        first, last = mark.lines
        wanted.update(range(first, min(first + SHOWN_AT_END, last) + 1))
        wanted.update(range(max(last - SHOWN_AT_END, first), last + 1))
    ordered = sorted(wanted)
    # A gap of one line is better filled with that line than with dots.
    wanted.update(line + 1 for line, following in pairwise(ordered) if following - line == 2)
    return sorted(wanted)


class _Brackets:
    """The margin with the brackets of the marks over several lines, one column each."""

    def __init__(self, marks: Sequence[Mark], paint: Paint) -> None:
        self._marks = sorted(marks, key=lambda mark: mark.lines)
        self._paint = paint
        self.width = len(self._marks)

    def beside_line(self, number: int) -> str:
        """The margin of a source line."""
        return self._row(lambda first, last: "/" if number == first else "|" if first < number <= last else " ")

    def below_line(self, number: int) -> str:
        """The margin of what is below a source line, or between it and the next one shown."""
        return self._row(lambda first, last: "|" if first <= number < last else " ")

    def ends(self, line: _Line) -> list[str]:
        """The rows that close the brackets that end in ``line``, with their words."""
        rows: list[str] = []
        for column, mark in enumerate(self._marks):
            if mark.lines[1] != line.number:
                continue
            others = [
                self._paint("|" if other.lines[0] <= line.number < other.lines[1] else " ", other.role)
                for other in self._marks[:column]
            ]
            reach = self.width - column + max(line.end_cell(mark) - 1, 0)
            words = f" {mark.message}" if mark.message else ""
            rows.append("".join(others) + self._paint("|" + "_" * reach + mark.stroke + words, mark.role))
        return rows

    def _row(self, symbol: Callable[[int, int], str]) -> str:
        drawn = [self._paint(symbol(*mark.lines), mark.role) for mark in self._marks]
        return "".join(drawn) + (" " if drawn else "")


def draw(source: SourceFile, marks: Sequence[Mark], gutter: int, paint: Paint) -> list[str]:
    """The lines of a snippet of ``source``, with a gutter of ``gutter`` cells for the line numbers."""
    within = [mark for mark in marks if mark.lines[0] == mark.lines[1]]
    brackets = _Brackets([mark for mark in marks if mark.lines[0] != mark.lines[1]], paint)
    bar = " " * gutter + paint(" | ", "frame")
    drawn: list[str] = []
    previous: int | None = None
    for number in _visible_lines(marks):
        if previous is not None and number != previous + 1:
            drawn.append(paint("...".ljust(gutter + 3), "frame") + brackets.below_line(previous))
        line = _Line(source, number, [mark for mark in within if mark.lines[0] == number])
        head = paint(f"{number:>{gutter}} | ", "frame") + brackets.beside_line(number)
        drawn.append(head + line.text)
        if line.rows:
            drawn += [bar + brackets.below_line(number) + row for row in _underlines(line, paint)]
        drawn += [bar + row for row in brackets.ends(line)]
        previous = number
    return [row.rstrip() for row in drawn]
