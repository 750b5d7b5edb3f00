"""Recordings contain what was measured: every sample of a sampled input, read or not; vectors and structs as
numbers.
"""

from __future__ import annotations

import csv
import io
from array import array
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path

import numpy
import pytest

import cspdiag
from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.cli.main import main
from cspdiag.simulate.native.build import CompilerError, find_compiler
from cspdiag.simulate.record.files import csv_parts, write_npz
from cspdiag.simulate.record.recorder import Recorder
from cspdiag.simulate.result import Run
from cspdiag.simulate.run import execute

DRIVE = """
struct Pose {
  x : double
  at : double[2]
}

enum Mode { idle, busy }

process Drive {
  in  speed : double    @ 10 ms
  in  gyro  : double[3] @ 20 ms
  in  pose  : Pose      @ 20 ms
  in  mode  : Mode      @ 15 ms
  in  button : bool
  out power : double    @ 10 ms
  out shown : double[2] @ 20 ms

  communication {
    var v : double = 0
    var g : double[3] = [0, 0, 0]
    var p : Pose
    var b : bool
  }

  composition {
    (seq i < 5 : (speed ? v ; power ! v)) ;
    (gyro ? g || pose ? p) ;
    shown ! [g[0], p.at[1]] ;
    button ? b ;
    shown ! [1, 2] ;
    wait 43 ms
  }
}

submodel Plant {
  in  power : double
  in  shown : double[2]
  out speed : double
  out gyro  : double[3]
  out pose  : Pose
  out mode  : Mode
  out button : bool

  state t : int = 0
  next t = t + 1
  speed = double(t) + 0 * power
  gyro = [double(t), 2 * double(t), 3 * double(t) + 0 * shown[0]]
  pose = Pose(x = double(t), at = [double(t), -double(t)])
  mode = if t % 60 > 30 then Mode.busy else Mode.idle
  button = t > 200
}

environment Bench for Drive step 1 ms {
  plant : Plant

  power -> plant.power
  shown -> plant.shown
  plant.speed  -> speed
  plant.gyro   -> gyro
  plant.pose   -> pose
  plant.mode   -> mode
  plant.button -> button
}
"""

WAYS = [("python", 0), ("python", 1), ("c", 0), ("c", 1)]


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> cspdiag.LoadedProgram:
    path = tmp_path_factory.mktemp("samples") / "drive.csp"
    path.write_text(DRIVE)
    return cspdiag.load(str(path))


@pytest.fixture(scope="module")
def run(program: cspdiag.LoadedProgram) -> Run:
    return program.run("Bench")


def columns(text: str) -> Mapping[str, list[str]]:
    rows = list(csv.DictReader(io.StringIO(text)))
    return {name: [row[name] for row in rows] for name in rows[0]}


def test_a_sampled_input_is_recorded_at_every_tick_read_or_not(run: Run) -> None:
    assert run.outcome.time == 244_000_000
    assert run.time("speed") == pytest.approx(numpy.arange(1, 25) * 0.01)
    assert run["speed"].tolist() == [10.0 * k for k in range(1, 25)]
    # It is never read.
    assert run.time("mode") == pytest.approx(numpy.arange(1, 17) * 0.015)
    recorded = columns("".join(csv_parts(run)))
    assert dict(zip(recorded["time"], recorded["speed"], strict=True))["0.24"] == "240.0"
    assert recorded["mode"][-1] == "idle"
    assert "busy" in recorded["mode"]


def test_each_tick_has_a_row_up_to_the_last_one(program: cspdiag.LoadedProgram) -> None:
    recorded = columns("".join(csv_parts(program.run("Bench", until="120 ms"))))
    assert recorded["time"][-1] == "0.12"
    assert recorded["speed"][-1] == "120.0"


def test_only_what_was_read_is_a_communication(run: Run) -> None:
    read = [passed.time // 1_000_000 for passed in run.communications if passed.channel == "Drive.speed"]
    assert read == [10, 20, 30, 40, 50]
    assert not [passed for passed in run.communications if passed.channel == "Drive.mode"]


def test_unread_samples_are_known(run: Run) -> None:
    assert run.unread("speed") == [False] * 5 + [True] * 19
    assert run.unread("mode") == [True] * 16
    assert list(run.unread("power")) == []


@pytest.mark.parametrize(("target", "level"), WAYS)
def test_recordings_are_equal_byte_for_byte(program: cspdiag.LoadedProgram, run: Run, target: str, level: int) -> None:
    if target == "c":
        try:
            find_compiler()
        except CompilerError:
            pytest.skip("no C compiler")
    other = program.run("Bench", target=target, level=level)
    assert "".join(csv_parts(other)) == "".join(csv_parts(run))
    for name, signal in run.signals.items():
        if "." not in name:
            assert (other[name] == signal.value).all()


@pytest.mark.parametrize("level", [0, 1])
def test_ports_that_note_their_values_record_the_same(
    program: cspdiag.LoadedProgram, run: Run, level: int, tmp_path: Path
) -> None:
    network = program.network
    recorder = Recorder(ports={f"Drive.{port.name}": port.type for port in network.external_ports})
    files = pipeline.generate(network, read_source, level=level, observed=True)
    noted = execute.simulate(network, files, recorder=recorder)
    assert "".join(csv_parts(noted)) == "".join(csv_parts(run))
    run.to_npz(tmp_path / "all.npz")
    noted.to_npz(tmp_path / "noted.npz")
    assert (tmp_path / "noted.npz").read_bytes() == (tmp_path / "all.npz").read_bytes()
    assert noted.activities == run.activities
    assert noted.releases == run.releases
    assert list(noted.communications) == []
    assert recorder.port_logs is not None
    assert [type(values) for _, values in recorder.port_logs.values()].count(array) == 4, "numbers need 8 bytes each"


@pytest.mark.parametrize(("target", "level"), WAYS)
@pytest.mark.parametrize("ending", ["csv", "npz"])
def test_a_recording_does_not_depend_on_what_else_is_written(
    tmp_path: Path, target: str, level: int, ending: str
) -> None:
    if target == "c":
        try:
            find_compiler()
        except CompilerError:
            pytest.skip("no C compiler")
    (tmp_path / "drive.csp").write_text(DRIVE)
    run = ["run", str(tmp_path / "drive.csp"), f"-O{level}", "--target", target, "--quiet"]
    alone, together = tmp_path / f"alone.{ending}", tmp_path / f"together.{ending}"
    assert main([*run, "--record", str(alone)]) == 0
    assert main([*run, "--record", str(together), "--trace", str(tmp_path / "trace.jsonl")]) == 0
    assert alone.read_bytes() == together.read_bytes()


def test_vectors_and_structs_have_a_column_for_each_number(run: Run) -> None:
    recorded = columns("".join(csv_parts(run)))
    assert list(recorded) == [
        "time", "speed", "gyro[0]", "gyro[1]", "gyro[2]", "pose.x", "pose.at[0]", "pose.at[1]", "mode", "button",
        "power",
        "shown[0]", "shown[1]",
    ]  # fmt: skip
    last = {name: values[-1] for name, values in recorded.items()}
    assert (last["gyro[2]"], last["pose.x"], last["pose.at[1]"]) == ("720.0", "240.0", "-240.0")


def test_vectors_are_arrays_of_numbers_in_archives(run: Run) -> None:
    file = io.BytesIO()
    write_npz(run, file)
    file.seek(0)
    with numpy.load(file, allow_pickle=False) as archive:
        assert archive["gyro"].shape == (12, 3)
        assert archive["gyro"].dtype == float
        assert archive["gyro"][-1].tolist() == [240.0, 480.0, 720.0]
        assert archive["gyro.time"] == pytest.approx(numpy.arange(1, 13) * 0.02)
        assert archive["pose"]["at"].shape == (12, 2)
        assert archive["pose"]["x"].tolist() == [20.0 * k for k in range(1, 13)]
        assert archive["button"].dtype == bool


def test_vectors_without_a_value_have_their_shape(program: cspdiag.LoadedProgram) -> None:
    assert program.run("Bench", until="5 ms")["gyro"].shape == (0, 3)


def test_what_is_recorded_is_in_the_order_of_time(run: Run) -> None:
    times = [float(time) for time in columns("".join(csv_parts(run)))["time"]]
    assert all(one < other for one, other in pairwise(times))
