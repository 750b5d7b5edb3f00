"""Rows of declarations whose parts are aligned in columns."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from cspdiag.base.record import record
from cspdiag.syntax.format.layout import Padding, flat_width
from cspdiag.syntax.format.writer import Writer

_MAX_ALIGNED_WIDTH = 40
"""Cells wider than this are left out of the alignment of their column."""


@record
class Cell:
    """A part of a row with the padding after it; ``width`` is None if it cannot be on one line."""

    width: int | None
    padding: Padding


class Columns:
    """The rows of a block. Consecutive rows of the same kind are aligned."""

    def __init__(self, writer: Writer) -> None:
        self._writer = writer
        self._kind = ""
        self._rows: list[list[Cell]] = []

    def begin_row(self, kind: str, *, blank: bool | None = None) -> None:
        """Begin the line of a row; ``blank`` as for ``Writer.begin_line``. Rows without a kind are not aligned."""
        directly = self._writer.begin_line(blank=blank)
        if not directly or kind != self._kind or not kind:
            self.end()
        self._kind = kind
        self._rows.append([])

    @contextmanager
    def cell(self) -> Iterator[None]:
        """Pad what is written in this context to the width of its column."""
        row = self._rows[-1]
        begin = len(self._writer.pieces)
        yield
        row.append(Cell(flat_width(self._writer.pieces[begin:]), self._writer.padding()))

    def end(self) -> None:
        """Set the widths of the cells of the rows so far."""
        rows, self._rows = self._rows, []
        for column in range(max(map(len, rows), default=0)):
            cells = [row[column] for row in rows if column < len(row)]
            narrow = [
                (cell.width, cell) for cell in cells if cell.width is not None and cell.width <= _MAX_ALIGNED_WIDTH
            ]
            widest = max((width for width, _ in narrow), default=0)
            for width, cell in narrow:
                cell.padding.width = widest - width
