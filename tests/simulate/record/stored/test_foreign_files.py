"""Inputs from tables and archives that other programs have written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy
import pytest

from cspdiag.cli.main import main

PROGRAM = """
process Main {
  in  level : double @ 10 ms
  in  gyro  : double[2] @ 10 ms
  in  go    : int
  out valve : double @ 10 ms safe 0

  communication {
    var height : double    = 0
    var rates  : double[2] = [0, 0]
    var number : int       = 0
  }

  composition {
    mu (go ? number -> skip []> level ? height -> (gyro ? rates ; valve ! height + rates[1] + double(number)))
  }
}
"""
HEADER = "time,level,gyro[0],gyro[1],go"


def given(folder: Path, inputs: Path) -> int:
    """The exit code of a run with these inputs."""
    (folder / "main.csp").write_text(PROGRAM)
    return main(["run", str(folder / "main.csp"), "--inputs", str(inputs), "--record", str(folder / "out.csv")])


@pytest.mark.parametrize(
    "table",
    [
        b"\xef\xbb\xbf" + f"{HEADER}\r\n0.01,1,2,3,4\r\n0.02,1.5,2,3,4\r\n".encode(),
        b"time, level, gyro[0], gyro[1], go\n0.01, 1, 2, 3, 4\n0.02, 1.5, 2, 3, 4\n",
        f'{HEADER}\n"0.01","1","2","3","4"\n"0.02","1.5","2","3","4"\n'.encode(),
    ],
    ids=["spreadsheet", "spaces", "quoted"],
)
def test_tables_of_other_programs_have_inputs(tmp_path: Path, table: bytes) -> None:
    (tmp_path / "in.csv").write_bytes(table)
    assert given(tmp_path, tmp_path / "in.csv") == 0
    assert (tmp_path / "out.csv").read_text().splitlines()[1].startswith("0.01,1.0,2.0,3.0,4,")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (
            "time;level;gyro[0]\n0,01;1,5;2\n",
            ":1: is no recording: its cells are separated by semicolons: write commas",
        ),
        ("time\tlevel\n0.01\t1\n", ":1: is no recording: its cells are separated by tabs"),
        ("time,level,level\n0.01,1,2\n", ":1: has the column `level` twice"),
        (
            f"{HEADER}\n0.02,1,2,3,4\n0.01,1,2,3,4\n",
            ":3: is no row of a recording: its time, 0.01 s, is before that of",
        ),
        (f"{HEADER}\n", " has no values"),
        (f"{HEADER}\n0.01,high,2,3,4\n", ": column level is no double: could not convert string to float: 'high'"),
        (f"{HEADER}\n0.01,1,2,3\n", ":2: is no row of a recording: 4 cells, and there are 5 columns"),
    ],
    ids=["semicolons", "tabs", "twice", "order", "empty", "text", "ragged"],
)
def test_a_table_that_cannot_be_right_is_refused(
    tmp_path: Path, text: str, reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "in.csv").write_text(text)
    assert given(tmp_path, tmp_path / "in.csv") == 1
    assert f"in.csv{reason}" in capsys.readouterr().err
    assert not (tmp_path / "out.csv").exists()


def archive(folder: Path, **changed: Any) -> Path:
    """An archive that fits, but for what is changed."""
    time = numpy.array([0.01, 0.02])
    arrays: dict[str, Any] = {
        "level": numpy.array([1.0, 1.5]), "gyro": numpy.array([[2.0, 3.0], [2.0, 3.0]]), "go": numpy.array([4, 5]),
    }  # fmt: skip
    arrays |= {f"{name}.time": time for name in arrays} | changed
    numpy.savez(folder / "in.npz", **arrays)
    return folder / "in.npz"


def test_archives_of_other_programs_have_inputs(tmp_path: Path) -> None:
    assert given(tmp_path, archive(tmp_path)) == 0
    assert (tmp_path / "out.csv").read_text().splitlines()[1].startswith("0.01,1.0,2.0,3.0,4,")


@pytest.mark.parametrize(
    ("name", "array", "reason"),
    [
        ("level", numpy.array([1.0, 2.0, 3.0]), " has 2 instants level.time, and 3 values of level"),
        ("level", numpy.array(1.0), " has 2 instants level.time, and 1 values of level"),
        ("level", numpy.array([[1.0, 2.0], [3.0, 4.0]]), ": level is a double[2], and the input `level` ("),
        ("gyro", numpy.array([1.0, 2.0]), ": gyro is a double, and the input `gyro` ("),
        ("go", numpy.array([0.5, 1.5]), ": go is a double, and the input `go` ("),
        ("level", numpy.array(["a", "b"]), " does not say of what type level is"),
        ("level.time", numpy.array([0.01, numpy.nan]), ": level.time is no array of instants in seconds"),
        ("level.time", numpy.array(["1", "2"]), ": level.time is no array of instants in seconds"),
        ("level.time", numpy.array([0.02, 0.01]), ": the instants level.time are not in their order"),
    ],
)
def test_an_archive_that_cannot_be_right_is_refused(
    tmp_path: Path, name: str, array: Any, reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert given(tmp_path, archive(tmp_path, **{name: array})) == 1
    assert f"in.npz{reason}" in capsys.readouterr().err
    assert not (tmp_path / "out.csv").exists()
