"""The file of a sweep that is not finished: results as they are known, so another process can continue."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, BinaryIO, Self

from cspdiag.base.errors import CspdiagError
from cspdiag.sweep.columns import cells_of, columns_of, csv_line
from cspdiag.sweep.result import ENDINGS, Result

if TYPE_CHECKING:
    from cspdiag.sweep.plan import Plan

_MARK = "# cspdiag sweep "


class ResumeError(CspdiagError):
    """What is there of an earlier sweep cannot be continued; the message is one line."""


def partial_path(output: Path) -> Path:
    """The file next to the table of a sweep, while that is not finished."""
    return output.with_name(f"{output.name}.partial")


class PartialTable:
    """Writes results to a file, a line of CSV each, in the order in which they are known. Its first line identifies the
    sweep.
    """

    def __init__(self, plan: Plan, output: Path, *, resume: bool, version: str) -> None:
        """Raises ResumeError if there are results that would be lost, or that belong to another sweep: one of another
        program, with other values or measures, or of another ``version`` of cspdiag.
        """
        self.path = partial_path(output)
        self._plan = plan
        mark = f"{_MARK}{plan.token(version)}"
        self.known: Mapping[int, Result] = {}
        """The results of an earlier process."""
        length = 0
        if self.path.exists():
            if not resume:
                raise ResumeError(
                    f"{self.path} has results of an interrupted sweep: --resume continues it; otherwise remove it"
                )
            self.known, length = _read(plan, self.path, mark)
        self._file: BinaryIO = open(self.path, "r+b" if length else "wb", buffering=0)  # noqa: SIM115
        self._file.seek(length)
        self._file.truncate()
        if not length:
            self._write(f"{mark}\n{csv_line(columns_of(plan.grid, plan.measures))}")

    def add(self, run: int, result: Result) -> None:
        """Write a result. Raises OSError, with the name of the file, if there is no room."""
        self._write(csv_line(cells_of(self._plan.grid, run, result)))

    def _write(self, text: str) -> None:
        data = text.encode()
        try:
            while data:
                data = data[self._file.write(data) :]
        except OSError as problem:
            raise OSError(problem.errno, problem.strerror, os.fspath(self.path)) from None

    def remove(self) -> None:
        """Remove the file: the table is whole."""
        self._file.close()
        self.path.unlink(missing_ok=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()


def _read(plan: Plan, path: Path, mark: str) -> tuple[dict[int, Result], int]:
    """The results in a file, and the length of its part that is whole: the process may have ended in a line."""
    data = path.read_bytes()
    whole = data[: data.rfind(b"\n") + 1]
    lines = whole.decode("utf-8", "replace").splitlines(keepends=True)
    if not lines:
        return {}, 0
    if lines[0].rstrip() != mark:
        raise ResumeError(
            f"{path} belongs to another sweep: the program, the values, the measures or the version of cspdiag were "
            "others; remove it to begin again"
        )
    found: dict[int, Result] = {}
    first = len(plan.grid.axes) + 1
    last = first + len(plan.measures.measures)
    for row in csv.reader(lines[2:]):
        measured = tuple(float(cell) if cell else None for cell in row[first:last])
        ended = next(known for known in ENDINGS if known == row[last])
        found[int(row[0])] = Result(ended, float(row[last + 1]), row[last + 2], measured)
    return found, len(whole)
