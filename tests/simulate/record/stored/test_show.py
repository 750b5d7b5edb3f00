"""``cspdiag show`` says what a recording of any format has, draws it, and saves it in any other."""

from __future__ import annotations

from pathlib import Path

import numpy
import pytest

from cspdiag.cli.main import main
from cspdiag.simulate.record.stored.open_recording import open_recording
from tests.simulate.record.streamed.test_formats import PROGRAM

NAMES = ("run.mcap", "run.parquet", "run.npz", "run.csv", "bag/")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("show")
    (folder / "drive.csp").write_text(PROGRAM)
    for name in NAMES:
        run = ["run", str(folder / "drive.csp"), "--for", "50ms", "--quiet", "--record", f"{folder}/{name}"]
        assert main(run) == 0
    return folder


@pytest.mark.parametrize("name", ["run.mcap", "run.parquet", "run.npz", "bag/"])
def test_types_units_and_numbers_are_shown(folder: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", f"{folder}/{name}"]) == 0
    rows = capsys.readouterr().out.splitlines()
    assert rows[0].endswith(", Drive in Bench")
    assert rows[1] == "  time limit at 50 ms"
    shown = {row.split()[0]: row.split()[1:] for row in rows[3:]}
    assert shown["speed"][:7] == ["double<rad/s>", "1", "ms", "50", "1", "ms", "50"]
    assert shown["pose"][:4] == ["Pose", "7", "ms", "7"]
    assert shown["small"][-2:] == ["-128", "-128"]


@pytest.mark.parametrize("other", NAMES)
@pytest.mark.parametrize("name", NAMES[:3])
def test_each_format_becomes_each_other(folder: Path, name: str, other: str, tmp_path: Path) -> None:
    saved = f"{tmp_path}/{other}"
    assert main(["show", f"{folder}/{name}", "--save", saved]) == 0
    first = open_recording(f"{folder}/{name}")
    again = open_recording(saved, first.head.ports)
    for port in first.head.ports:
        if other.endswith(".csv") and not port.is_sampled_input:
            continue  # A table does not show a value that was passed again.
        for found, expected in zip(again.values(port.name), first.values(port.name), strict=True):
            numpy.testing.assert_array_equal(found, expected)


def test_a_table_of_another_program_is_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "x.csv").write_text("time,a,b,c\n0.1,1,,low\n0.2,2,true,high\n0.3,3,false,low\n")
    assert main(["show", str(tmp_path / "x.csv"), "--plot", str(tmp_path / "x.svg")]) == 0
    rows = capsys.readouterr().out.splitlines()
    assert rows[1] == "  until 300 ms"
    assert rows[3].split()[:2] == ["a", "3"]
    assert (tmp_path / "x.svg").read_text().startswith("<?xml")


def test_the_last_row_of_a_table_that_was_cut_is_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "x.csv").write_text("time,a,b\n0.1,1,2.5\n0.2,2,3.125\n0.3,3,3.1")
    assert main(["show", str(tmp_path / "x.csv")]) == 1
    rows = capsys.readouterr().out.splitlines()
    assert "  not whole: the run was cut off; it has everything up to 200 ms" in rows
    assert [row.split()[1] for row in rows if row.split()[:1] == ["a"]] == ["2"]


def test_a_recording_that_was_cut_is_said_to_be(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cut = tmp_path / "run.part.mcap"
    data = (folder / "run.mcap").read_bytes()
    cut.write_bytes(data[: data.index(b"cspdiag.end")])
    assert main(["show", str(cut), "--save", str(tmp_path / "run.npz")]) == 1
    shown = capsys.readouterr().out.splitlines()
    assert shown[1] == "  not whole: the run was cut off; it has everything up to 50 ms"
    assert len(numpy.load(tmp_path / "run.npz")["speed"]) == 50
    assert main(["show", str(cut), "--save", str(tmp_path / "run.mcap")]) == 1
    assert open_recording(str(tmp_path / "run.mcap")).ended == "incomplete"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.mcap", "run.npz", "run.part.mcap"]


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("x.mcap", "no", "is no MCAP file"),
        ("x.csv", "a,b\n", "x.csv:1: is no recording"),
        ("x.csv", "time,b\n1,2\n2\n", "x.csv:3: is no row of a recording"),
        ("x.npz", "no", "is no archive of numpy"),
        ("x.parquet", "no", "is no Parquet file"),
        ("x.txt", "no", "is no recording: those end in"),
    ],
)
def test_what_is_no_recording_is_refused(
    tmp_path: Path, name: str, text: str, reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / name).write_text(text)
    assert main(["show", str(tmp_path / name)]) == 1
    assert reason in capsys.readouterr().err
    assert main(["show", str(tmp_path / f"no{name}")]) in (1, 2)
