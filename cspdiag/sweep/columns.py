"""The columns of the table of a sweep, and its rows as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from typing import Any

from cspdiag.sweep.axes import Cell, Grid
from cspdiag.sweep.measures import Measures
from cspdiag.sweep.result import Result


def columns_of(grid: Grid, measures: Measures) -> tuple[str, ...]:
    """The names of the columns: the number of the run, the names that vary, the measures, and how the run ended."""
    return ("run", *(axis.name for axis in grid.axes), *measures.names, "ended", "time", "error")


def cells_of(grid: Grid, run: int, result: Result) -> list[Cell | None]:
    """The row of a run."""
    values = [value.cell for _, value in grid.values(run)]
    return [run, *values, *result.measured, result.ended, result.time, result.error]


def units_of(grid: Grid, measures: Measures) -> dict[str, str]:
    """The units of the columns that have one."""
    from cspdiag.model.types import RealType, TimeType

    found = {"time": "s"}
    for axis in grid.axes:
        if isinstance(axis.target.type, RealType):
            found[axis.name] = axis.target.type.unit.text
        elif isinstance(axis.target.type, TimeType):
            found[axis.name] = "s"
    found.update((measure.text, measure.unit) for measure in measures.measures)
    return {name: unit for name, unit in found.items() if unit}


def csv_lines(columns: Sequence[str], rows: Iterator[list[Cell | None]]) -> Iterator[str]:
    """The lines of a table as CSV."""
    yield csv_line(list(columns))
    for row in rows:
        yield csv_line(row)


def csv_line(cells: Sequence[Cell | None]) -> str:
    """A line of CSV; times and other numbers with all digits, which ``repr`` gives."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow([_csv_cell(cell) for cell in cells])
    return text.getvalue()


def _csv_cell(cell: Any) -> Any:
    if isinstance(cell, bool):
        return "true" if cell else "false"
    return repr(cell) if isinstance(cell, float) else cell
