"""Changes of parameters are recorded, shown, and repeated with the inputs."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cspdiag.cli.main import main
from tests.simulate.record.stored.test_inputs import TARGETS, run, trace

PROGRAM = """
enum Mode { slow, fast }
struct Gains { kp: double<V/rad>  ti: time  table: int[2] }
parameter gains : Gains = Gains(kp = 2<V/rad>, ti = 10 ms, table = [1, 2])
parameter mode : Mode = Mode.slow
parameter on : bool = false
parameter near : float = 0.1
const share = 12 / (gains.table[1] - 2 * gains.table[0] + 4)

process Main {
  in  x : double @ 5 ms
  out y : double
  out n : int
  communication { var v : double }
  composition {
    mu (x ? v ; y ! v * gains.kp / 1<V/rad> * double(near) ; n ! share + (if mode == Mode.fast and on then 100 else 0))
  }
}
submodel Plant { out x : double  state n : double = 0  next n = n + gains.kp / 1<V/rad>  x = n }
environment World for Main step 1 ms { plant : Plant  plant.x -> x  y -> _  n -> _ }
"""
CHANGES = """on = true
near = 0.3
at 20 ms gains.kp = -0.0<V/rad>
at 20 ms gains.table[1] = 7
at 20 ms gains.table[0] = 3
at 31 ms mode = fast
at 42 ms gains.kp = 90<V/rad>
at 42 ms gains.ti = 1 s
at 50 ms gains.table[0] = 1
at 50 ms gains.table[1] = 1
"""
NAMES = ("run.mcap", "run.parquet", "run.npz", "run.csv", "bag/")


@pytest.fixture
def program(tmp_path: Path) -> Path:
    (tmp_path / "changes.txt").write_text(CHANGES)
    program = tmp_path / "main.csp"
    program.write_text(PROGRAM)
    return program


def tuned(program: Path, recording: str, *options: str) -> list[str]:
    """The trace of a run that is recorded, with changes."""
    first = program.parent / "first.jsonl"
    changes = ["--tune", str(program.parent / "changes.txt"), "--for", "70ms"]
    assert run(program, *changes, "--record", recording, "--trace", str(first), *options) == 0
    return trace(first)


def repeated(program: Path, recording: str, *options: str) -> list[str]:
    again = program.parent / "again.jsonl"
    assert run(program, "--inputs", recording, "--trace", str(again), *options) == 0
    return trace(again)


@pytest.mark.parametrize("options", TARGETS, ids=" ".join)
def test_a_run_is_repeated_with_its_changes(program: Path, options: list[str]) -> None:
    recording = f"{program.parent}/run.mcap"
    first = tuned(program, recording, *options)
    assert repeated(program, recording, *options) == first
    values = {json.loads(row)["value"] for row in first}
    assert {3, 2, 102, 104} <= values


@pytest.mark.parametrize("name", NAMES)
def test_every_format_has_the_changes(program: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    recording = f"{program.parent}/{name}"
    first = tuned(program, recording)
    assert repeated(program, recording) == first
    capsys.readouterr()
    assert main(["show", recording]) == 0
    shown = capsys.readouterr().out.partition("parameters, and their changes\n")[2].splitlines()
    for change in ("gains.kp = -0.0", "gains.table[1] = 7", "mode = fast", "on = true", "gains.kp = 90.0"):
        assert any(row.endswith(change) for row in shown), change
    again = f"{program.parent}/again.mcap"
    assert run(program, "--inputs", recording, "--record", again) == 0
    assert repeated(program, again) == first


@pytest.mark.parametrize("options", TARGETS[1::2], ids=" ".join)
def test_parameters_may_be_large(tmp_path: Path, options: list[str]) -> None:
    program = tmp_path / "main.csp"
    program.write_text(
        f"parameter table : double[900] = [{', '.join(['1'] * 900)}]\n"
        "process Main { out y : double  composition { mu (y ! table[0] + table[899] ; wait 10 ms) } }\n"
        "environment World for Main { y -> _ }\n"
    )
    (tmp_path / "changes.txt").write_text(
        f"at 20 ms table[899] = 5\nat 30 ms table = [{', '.join(map(str, range(900)))}]\n"
    )
    recording = f"{tmp_path}/run.mcap"
    first = tuned(program, recording, *options)
    assert [json.loads(row)["value"] for row in first] == [2, 2, 6, 899, 899, 899, 899, 899]
    assert repeated(program, recording, *options) == first


def test_a_file_of_changes_replaces_those_of_the_recording(program: Path) -> None:
    recording = f"{program.parent}/run.mcap"
    first = tuned(program, recording)
    (program.parent / "none.txt").write_text("")
    without = repeated(program, recording, "--tune", str(program.parent / "none.txt"))
    assert len(without) == len(first)
    assert without != first


@pytest.mark.parametrize("name", ["run.mcap", "run.csv"])
def test_a_program_with_other_parameters_is_refused(
    program: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = f"{program.parent}/{name}"
    tuned(program, recording)
    program.write_text(PROGRAM.replace("near", "far"))
    assert run(program, "--inputs", recording) == 1
    said = capsys.readouterr().err
    assert "far" in said
    assert "near" in said


def test_a_recording_without_changes_has_no_parameters(program: Path, tmp_path: Path) -> None:
    assert run(program, "--for", "10ms", "--record", f"{tmp_path}/run.csv") == 0
    assert (tmp_path / "run.csv").read_text().splitlines()[0] == "time,x,y,n"
