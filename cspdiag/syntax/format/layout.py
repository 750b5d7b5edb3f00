"""Text with possible line breaks, and the choice of which ones are used.

The pieces are a flat list. A group is kept on one line if it fits and contains no ``NEW_LINE``; otherwise each
``Break`` directly in it becomes a new line (Oppen, "Prettyprinting", 1980; Wadler, "A prettier printer", 1998).
"""

from __future__ import annotations

from enum import Enum, auto
from typing import TypeAlias, assert_never

WIDTH = 120
_INDENT = 2


class Mark(Enum):
    """Pieces without text of their own."""

    OPEN = auto()
    """A group begins."""
    CLOSE = auto()
    INDENT = auto()
    DEDENT = auto()
    BROKEN = auto()
    """The group is broken even if it fits."""
    NEW_LINE = auto()
    """An unconditional new line; nothing at the beginning of a line."""
    BLANK_LINE = auto()
    """A new line, with an empty line before it."""


class Break:
    """A new line in a broken group, ``flat`` in others.

    A break that ``fills`` is a new line only if the text up to the next break of its group does not fit.
    """

    def __init__(self, flat: str, *, fills: bool = False) -> None:
        self.flat = flat
        self.fills = fills


class Padding:
    """Spaces that align columns; their number is known only after all rows have been written."""

    def __init__(self) -> None:
        self.width = 0


Piece: TypeAlias = str | Mark | Break | Padding
Separator: TypeAlias = str | Mark | Break
"""The separator before a token."""

_BREAKING = (Mark.BROKEN, Mark.NEW_LINE, Mark.BLANK_LINE)

SPACE = Break(" ")
TWO_SPACES = Break("  ")
FILL = Break(" ", fills=True)
NOTHING = Break("")


def flat_width(pieces: list[Piece]) -> int | None:
    """The width of the pieces on one line; None if they cannot be on one line."""
    width = 0
    for piece in pieces:
        if piece in _BREAKING or (isinstance(piece, str) and "\n" in piece):
            return None
        width += _width(piece)
    return width


def _width(piece: Piece) -> int:
    match piece:
        case str():
            return len(piece)
        case Break():
            return len(piece.flat)
        case Padding():
            return piece.width
        case Mark():
            return 0
        case _:
            assert_never(piece)


def render(pieces: list[Piece]) -> str:
    """The text, which ends in one line break."""
    return _Renderer(pieces).run()


class _Renderer:
    def __init__(self, pieces: list[Piece]) -> None:
        self._pieces = pieces
        self._widths = _widths(pieces)
        self._lines: list[str] = []
        self._line = ""
        self._indent = 0
        self._at_start = True

    def run(self) -> str:
        broken = [True]
        for position, piece in enumerate(self._pieces):
            match piece:
                case str():
                    self._write(piece)
                case Padding():
                    self._write(" " * piece.width)
                case Break():
                    if broken[-1] and not (piece.fills and self._fits(self._widths[position])):
                        self._end_line()
                    else:
                        self._write(piece.flat)
                case Mark.OPEN:
                    broken.append(broken[-1] and not self._fits(self._widths[position]))
                case Mark.CLOSE:
                    broken.pop()
                case Mark.INDENT:
                    self._indent += 1
                case Mark.DEDENT:
                    self._indent -= 1
                case Mark.BROKEN:
                    pass
                case Mark.NEW_LINE:
                    self._end_line()
                case Mark.BLANK_LINE:
                    self._end_line()
                    if self._lines and self._lines[-1]:
                        self._lines.append("")
                case _:
                    assert_never(piece)
        self._end_line()
        return "\n".join(self._lines) + "\n" if self._lines else ""

    def _fits(self, width: int | None) -> bool:
        column = self._indent * _INDENT if self._at_start else len(self._line)
        return width is not None and column + width <= WIDTH

    def _write(self, text: str) -> None:
        if self._at_start:
            text = text.lstrip(" ")
            if not text:
                return
            self._line = " " * (self._indent * _INDENT)
            self._at_start = False
        *whole, rest = text.split("\n")
        for part in whole:
            self._lines.append((self._line + part).rstrip())
            self._line = ""
        self._line += rest

    def _end_line(self) -> None:
        if not self._at_start:
            self._lines.append(self._line.rstrip())
            self._line = ""
            self._at_start = True


def _widths(pieces: list[Piece]) -> dict[int, int | None]:
    """The width that has to fit on the line, for each piece that may be broken.

    For the opening of a group: the group on one line, with the text that follows up to the next possible break; None if
    it cannot be on one line. For a break that fills: the text up to the next break of its group, or up to the first new
    line before that.
    """
    ends, unbreakable = _extents(pieces)
    totals = [0]
    for piece in pieces:
        totals.append(totals[-1] + _width(piece))
    widths: dict[int, int | None] = {}
    # Going backwards: the next break of any kind, and the next unconditional new line.
    break_after: dict[int, int] = {}
    next_break = next_line = len(pieces)
    for position in range(len(pieces) - 1, -1, -1):
        piece = pieces[position]
        if position in ends and isinstance(piece, Break):
            widths[position] = totals[min(ends[position], next_line)] - totals[position]
        elif position in ends:
            end = break_after[ends[position]]
            widths[position] = None if position in unbreakable else totals[end] - totals[position]
        if piece is Mark.NEW_LINE or piece is Mark.BLANK_LINE:
            next_break = next_line = position
        elif piece is Mark.BROKEN:
            next_line = next_break
        elif isinstance(piece, Break):
            next_break = position
        elif piece is Mark.CLOSE:
            break_after[position] = next_break
    return widths


def _extents(pieces: list[Piece]) -> tuple[dict[int, int], set[int]]:
    """The end of each group and of the text after each filling break, and the groups that cannot be on one line."""
    ends: dict[int, int] = {}
    unbreakable: set[int] = set()
    opened: list[int] = []
    filling: list[int | None] = [None]
    for position, piece in enumerate(pieces):
        if isinstance(piece, Break) or piece is Mark.CLOSE:
            begun = filling[-1]
            if begun is not None:
                ends[begun] = position
            filling[-1] = position if isinstance(piece, Break) and piece.fills else None
        if piece is Mark.OPEN:
            opened.append(position)
            filling.append(None)
        elif piece is Mark.CLOSE:
            filling.pop()
            begin = opened.pop()
            ends[begin] = position
            if begin in unbreakable and opened:
                unbreakable.add(opened[-1])
        elif opened and (piece in _BREAKING or (isinstance(piece, str) and "\n" in piece)):
            unbreakable.add(opened[-1])
    if filling[0] is not None:
        ends[filling[0]] = len(pieces)
    return ends, unbreakable
