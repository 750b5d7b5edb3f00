"""The file of a sweep that is not finished: results as they are known, so another process can continue."""

from __future__ import annotations

import csv
import os
import zlib
from collections.abc import Mapping
from itertools import islice
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
    sweep; each line ends with a checksum of itself. A file without results is removed.
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
        self.damaged: tuple[int, ...] = ()
        """The numbers of the lines that are damaged, whose results are not known."""
        length = 0
        if self.path.exists() and _has_results(self.path):
            if not resume:
                raise ResumeError(
                    f"{self.path} has results of an interrupted sweep: --resume continues it; otherwise remove it"
                )
            self.known, self.damaged, length = _read(plan, self.path, mark)
        self._file: BinaryIO = open(self.path, "r+b" if length else "wb", buffering=0)  # noqa: SIM115
        self._has_results = bool(self.known)
        self._file.seek(length)
        self._file.truncate()
        if not length:
            self._write(f"{mark}\n{csv_line([*columns_of(plan.grid, plan.measures), 'checksum'])}")

    def add(self, run: int, result: Result) -> None:
        """Write a result. Raises OSError, with the name of the file, if there is no room."""
        self._has_results = True
        line = csv_line(cells_of(self._plan.grid, run, result)).rstrip("\n")
        self._write(f"{line},{zlib.crc32(line.encode())}\n")

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
        if not self._has_results:
            self.path.unlink(missing_ok=True)


def _has_results(path: Path) -> bool:
    """Whether a file has more than the two lines of its head."""
    with path.open("rb") as file:
        return len(list(islice(file, 3))) == 3


def _read(plan: Plan, path: Path, mark: str) -> tuple[dict[int, Result], tuple[int, ...], int]:
    """The results in a file, the numbers of its damaged lines, and the length of its part that is whole: the process
    may have ended in a line.
    """
    data = path.read_bytes()
    whole = data[: data.rfind(b"\n") + 1]
    lines = whole.split(b"\n")[:-1]
    if not lines:
        return {}, (), 0
    if lines[0] != mark.encode():
        raise ResumeError(
            f"{path} belongs to another sweep: the program, the values, the measures or the version of cspdiag were "
            "others; remove it to begin again"
        )
    found: dict[int, tuple[bytes, Result]] = {}
    damaged = []
    for number, line in enumerate(lines[2:], 3):
        entry = _entry(plan, line)
        if entry is None:
            damaged.append(number)
            continue
        run, result = entry
        if found.setdefault(run, (line, result))[0] != line:
            raise ResumeError(
                f"{path}:{number}: has another result of run {run} than a line before it; "
                "remove the file to begin again"
            )
    return {run: result for run, (_, result) in found.items()}, tuple(damaged), len(whole)


def _entry(plan: Plan, line: bytes) -> tuple[int, Result] | None:
    """A run and its result; None if the line is not as it was written."""
    text, _, checksum = line.rpartition(b",")
    if checksum != str(zlib.crc32(text)).encode():
        return None
    (row,) = csv.reader([text.decode()])
    first = len(plan.grid.axes) + 1
    last = first + len(plan.measures.measures)
    measured = tuple(float(cell) if cell else None for cell in row[first:last])
    ended = next(known for known in ENDINGS if known == row[last])
    return int(row[0]), Result(ended, float(row[last + 1]), row[last + 2], measured)
