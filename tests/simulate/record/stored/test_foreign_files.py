"""Inputs from tables and archives that other programs have written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy
import pytest

from cspdiag.cli.main import main
from cspdiag.simulate.native.build import CompilerError, find_compiler

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
        (f"{HEADER}\n0.01,1,2,3,4\n0.02,high,2,3,4\n", ":3: column `level`: 'high' is not a number"),
        (f"{HEADER}\n0.01,1,2,x,4\n", ":2: column `gyro[1]`: 'x' is not a number"),
        (f"{HEADER}\n0.01,1,2,3,4.5\n", ":2: column `go`: '4.5' is not a whole number"),
        (f"{HEADER}\n-0.01,1,2,3,4\n", ":2: is no row of a recording: -0.01 s is no time of a run"),
        (f"{HEADER}\n1e30,1,2,3,4\n", ":2: is no row of a recording: 1e30 s is no time of a run"),
        (f"{HEADER}\n0.01,1,2,3\n", ":2: is no row of a recording: 4 cells for 5 columns"),
    ],
    ids=["semicolons", "tabs", "twice", "order", "empty", "text", "element", "fraction", "negative", "late", "ragged"],
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
        ("level", numpy.array(1.0), " has 2 instants level.time, and one value of level"),
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


NARROW = """
enum Mode { off, on }

process Main {
  in  level : float @ 10 ms
  in  count : uint8 @ 10 ms
  in  mode  : Mode @ 10 ms
  out valve : double @ 10 ms safe 0

  communication {
    var height : float = 0
    var number : uint8 = 0
    var chosen : Mode  = Mode.off
  }

  composition {
    mu (level ? height -> count ? number -> mode ? chosen -> valve ! double(height) + double(number))
  }
}
"""


def narrow(folder: Path, target: str, inputs: Path) -> int:
    (folder / "main.csp").write_text(NARROW)
    if target == "c":
        try:
            find_compiler()
        except CompilerError as problem:
            pytest.skip(str(problem))
    record = ["--record", str(folder / f"{target}.csv")]
    return main(["run", str(folder / "main.csp"), "--target", target, "--inputs", str(inputs), *record])


def narrow_archive(folder: Path, **changed: Any) -> Path:
    time = numpy.array([0.01, 0.02])
    arrays = {"level": numpy.array([0.1, 0.2]), "count": numpy.array([1, 255]), "mode": numpy.array([0, 1])} | changed
    numpy.savez(folder / "in.npz", **arrays, **{f"{name}.time": time for name in arrays})
    return folder / "in.npz"


def test_numbers_of_double_precision_are_rounded_for_a_float(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text("time,level,count,mode\n0.01,0.1,1,off\n0.02,0.2,255,on\n")
    for inputs in (tmp_path / "in.csv", narrow_archive(tmp_path)):
        for target in ("python", "c"):
            assert narrow(tmp_path, target, inputs) == 0
            assert (tmp_path / f"{target}.csv").read_text().splitlines()[1:] == [
                "0.01,0.10000000149011612,1,off,", "0.02,0.20000000298023224,255,on,0.0",
            ]  # fmt: skip


@pytest.mark.parametrize("target", ["python", "c"])
@pytest.mark.parametrize(
    ("row", "reason"),
    [
        ("0.1,256,on", "column `count`: 256 is no uint8: those are from 0 to 255"),
        ("0.1,-1,on", "column `count`: -1 is no uint8"),
        (f"0.1,{10**30},on", f"column `count`: {10**30} is no uint8"),
        ("1e39,1,on", "column `level`: 1e+39 is no float"),
        ("0.1,1,open", "column `mode`: 'open' is none of off, on"),
    ],
)
def test_a_cell_that_is_no_value_of_its_input_is_refused(
    tmp_path: Path, row: str, reason: str, target: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "in.csv").write_text(f"time,level,count,mode\n0.01,0.1,1,off\n0.02,{row}\n")
    assert narrow(tmp_path, target, tmp_path / "in.csv") == 1
    assert f"in.csv:3: {reason}" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "array", "reason"),
    [
        ("count", numpy.array([1, 256]), "count at 20 ms: 256 is no uint8: those are from 0 to 255"),
        ("count", numpy.array([-1, 256]), "count at 10 ms: -1 is no uint8"),
        ("level", numpy.array([1e39, 0]), "level at 10 ms: 1e+39 is no float"),
        ("mode", numpy.array([0, 2]), "mode at 20 ms: 2 is no Mode: those are 0 (off), 1 (on)"),
    ],
)
def test_an_element_that_is_no_value_of_its_input_is_refused(
    tmp_path: Path, name: str, array: Any, reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert narrow(tmp_path, "python", narrow_archive(tmp_path, **{name: array})) == 1
    assert f"in.npz: {reason}" in capsys.readouterr().err


def test_a_parquet_file_without_a_column_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    assert given(tmp_path, archive(tmp_path)) == 0
    path = str(tmp_path / "run.parquet")
    assert main(["run", str(tmp_path / "main.csp"), "--inputs", str(tmp_path / "in.npz"), "--record", path]) == 0
    table = parquet.read_table(path)
    parquet.write_table(table.drop_columns(["gyro[1]"]), path)
    assert main(["run", str(tmp_path / "main.csp"), "--inputs", path]) == 1
    assert "run.parquet has no column gyro[1]; it has: time, level, gyro[0], go, valve" in capsys.readouterr().err
