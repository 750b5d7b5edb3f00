"""The table of a sweep: a row for each run, with its values, what was measured, and how it ended."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from cspdiag.base.errors import ArgumentError, file_errors, missing_package
from cspdiag.base.files.whole import whole_file
from cspdiag.model.wording import counted
from cspdiag.sweep.axes import Cell, Grid
from cspdiag.sweep.columns import cells_of, columns_of, csv_lines, units_of
from cspdiag.sweep.measures import Measures
from cspdiag.sweep.result import FAILED, Result

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

ENDINGS = (".csv", ".parquet")


class Sweep:
    """The result of a sweep. ``rows`` has a mapping for each run, from the names of the columns to values; None where
    nothing was measured.
    """

    def __init__(self, grid: Grid, measures: Measures, results: Mapping[int, Result], made: str) -> None:
        self._grid = grid
        self._measures = measures
        self._results = [results[run] for run in sorted(results)]
        self.made = made
        """How the runs were made: ``as a native program``, or in Python and why."""

    def __len__(self) -> int:
        return len(self._results)

    def __repr__(self) -> str:
        return f"<Sweep of {counted(len(self), 'run')}: {self.summary()}>"

    def summary(self) -> str:
        """How many runs ended in which way, in one line."""
        counts: dict[str, int] = {}
        for result in self._results:
            counts[result.ended] = counts.get(result.ended, 0) + 1
        return ", ".join(f"{count} {ended}" for ended, count in counts.items()) or "no runs"

    @property
    def failure(self) -> str | None:
        """If no run has a result, because all have failed, crashed or were refused: the reason of the first one."""
        if not self._results or any(result.ended not in FAILED for result in self._results):
            return None
        return self._results[0].error

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the columns."""
        return columns_of(self._grid, self._measures)

    @property
    def rows(self) -> list[dict[str, Cell | None]]:
        """The table."""
        return [dict(zip(self.columns, cells, strict=True)) for cells in self._cells()]

    def _cells(self) -> Iterator[list[Cell | None]]:
        for run, result in enumerate(self._results):
            yield cells_of(self._grid, run, result)

    def to_dataframe(self) -> pandas.DataFrame:
        """The table, indexed by the number of the run; ``attrs`` has the ``units`` of the columns. Raises
        MissingPackageError with the command to install pandas if it is missing.
        """
        try:
            import pandas
        except ImportError:
            raise missing_package("pandas", "pandas") from None
        columns = list(zip(*self._cells(), strict=True)) or [()] * len(self.columns)
        measured = set(self._measures.names)
        frame = pandas.DataFrame(
            {
                name: pandas.Series(cells, dtype=float if name in measured else None)
                for name, cells in zip(self.columns, columns, strict=True)
            }
        )
        frame.attrs = {"units": units_of(self._grid, self._measures)}
        return frame.set_index("run")

    def to_csv(self, path: str | Path) -> None:
        """Write the table as CSV: numbers with all their digits, nothing where nothing was measured."""
        with file_errors(), whole_file(path) as file:
            file.writelines(line.encode() for line in csv_lines(self.columns, self._cells()))

    def to_parquet(self, path: str | Path) -> None:
        """Write the table as Parquet. Raises MissingPackageError without pyarrow."""
        try:
            import pyarrow
            from pyarrow import parquet
        except ImportError:
            raise missing_package("pyarrow", "parquet") from None
        columns = list(zip(*self._cells(), strict=True)) or [()] * len(self.columns)
        measured = set(self._measures.names)
        arrays = {
            name: pyarrow.array(cells, type=pyarrow.float64() if name in measured else None)
            for name, cells in zip(self.columns, columns, strict=True)
        }
        with file_errors(), whole_file(path) as file:
            parquet.write_table(pyarrow.table(arrays), file)

    def plot(self, path: str | Path | None = None) -> Figure:
        """A panel for each measure; written to ``path`` if given. Raises MissingPackageError without matplotlib, and
        ArgumentError for a sweep without numbers to draw.
        """
        from cspdiag.sweep.plot import plot

        with file_errors():
            return plot(self._grid, self._measures, self.rows, None if path is None else Path(path))

    def write(self, path: Path) -> None:
        """Write the table in the format of the name of a file. Raises ArgumentError for an unknown one."""
        match path.suffix:
            case ".csv":
                self.to_csv(path)
            case ".parquet":
                self.to_parquet(path)
            case _:
                raise ArgumentError(f"a table is written as {' or '.join(ENDINGS)}, not as {path.name}")


def text_lines(sweep: Sweep) -> Iterator[str]:
    """The table for people: columns side by side, numbers with six digits; without columns that are empty."""
    header = list(sweep.columns)
    rows = [[_shown(cell) for cell in row.values()] for row in sweep.rows]
    kept = [at for at, name in enumerate(header) if name != "error" or any(row[at] for row in rows)]
    widths = [max(len(header[at]), *(len(row[at]) for row in rows)) if rows else len(header[at]) for at in kept]
    for row in (header, *rows):
        yield "  ".join(f"{row[at]:>{width}}" for at, width in zip(kept, widths, strict=True)).rstrip()


def _shown(cell: Cell | None) -> str:
    if isinstance(cell, bool):
        return str(cell).lower()
    if isinstance(cell, float):
        return f"{cell:.6g}"
    return "" if cell is None else str(cell)
