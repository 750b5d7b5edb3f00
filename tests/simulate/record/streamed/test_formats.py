"""What the readers of others find in a recording is what the run has passed: every value to the bit, at its nanosecond,
on every target.
"""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import numpy
import pytest

import cspdiag
from cspdiag.cli.main import main
from cspdiag.model.types import BoolType, EnumType
from cspdiag.simulate.native.build import CompilerError, find_compiler
from cspdiag.simulate.record.files import csv_parts
from cspdiag.simulate.record.leaves import leaf_of_each, leaves
from cspdiag.simulate.record.run_data import histories
from cspdiag.simulate.record.streamed.mcap.messages import topics
from cspdiag.simulate.result import Run
from tests.simulate.record.streamed.oracles import Seen, by_mcap, by_pyarrow, by_rosbags

PROGRAM = """
enum Mode { idle, tooHot, done }
struct Inner { deep : float  on : bool }
struct Pose { tauD : double<s>  at : double[2]  mode : Mode  inner : Inner[2] }

process Drive {
  in  speed  : double<rad/s> @ 1 ms
  in  gyro   : float[3]      @ 2 ms
  in  pose   : Pose          @ 7 ms
  in  grid   : double[2][3]  @ 5 ms
  in  late   : time          @ 3 ms
  in  small  : int8          @ 3 ms
  in  button : Mode
  out power  : double<W>     @ 1 ms safe -1<W>
  out large  : uint32        @ 2 ms
  out shown  : Pose
  out seen   : bool

  communication {
    var v : double<rad/s> = 0
    var p : Pose
    var m : Mode
    var n : uint32 = 4294967290
    gyro -> _  grid -> _  late -> _  small -> _
  }
  composition {
    (mu (speed ? v ; power ! (v * 1<J/rad>)))
    ||
    (mu (pose ? p ; shown ! p ; n := (if n > 4294967200 then n - 1 else n) ; large ! n))
    ||
    (mu (button ? m ; seen ! (m == Mode.tooHot) ; seen ! (m == Mode.done)))
  }
}

submodel Plant {
  in  power : double<W>
  out speed : double<rad/s>
  out gyro : float[3]
  out pose : Pose
  out grid : double[2][3]
  out late : time
  out small : int8
  out button : Mode
  speed = sin(time / 1<s> * 37) * 1<rad/s>
  gyro = [float(0.1), float(time / 1<s>), float(3)]
  pose = Pose(tauD = time, at = [0.1, time / 3<s>], mode = if time < 20 ms then Mode.idle else Mode.done,
              inner = [Inner(deep = float(0.3), on = true), Inner(deep = float(time / 1<s>), on = false)])
  grid = [[0.1, 0.2, 0.3], [time / 7<s>, 1e-300, -0.0]]
  late = 123 us
  small = -128
  button = if time < 11 ms then Mode.idle else if time < 23 ms then Mode.tooHot else Mode.done
}

environment Bench for Drive {
  plant : Plant
  plant.speed -> speed
  plant.gyro -> gyro
  plant.pose -> pose
  plant.grid -> grid
  plant.late -> late
  plant.small -> small
  plant.button -> button
  power -> plant.power
  large -> _
  shown -> _
  seen -> _
}
"""


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("formats") / "drive.csp"
    path.write_text(PROGRAM)
    return path


@pytest.fixture(scope="module")
def run(program: Path) -> Run:
    return cspdiag.load(program).run(until="100 ms")


def seen_by_run(run: Run, *, names_of_literals: bool) -> Seen:
    found: Seen = {}
    passed = histories(run)
    for port in run.network.external_ports:
        history = passed[f"{run.network.top}.{port.name}"]
        values = history.array(port.type)
        columns = []
        for _, kind, path in leaves(port.name, port.type):
            own = numpy.asarray(leaf_of_each(values, path)).tolist()
            is_name = isinstance(kind, EnumType) and names_of_literals
            columns.append([kind.literals[value] for value in own] if is_name else own)  # type: ignore[union-attr]
        found[port.name] = list(zip(map(int, history.time), map(list, zip(*columns, strict=True)), strict=True))
    return found


def equal(found: Seen, expected: Seen) -> None:
    """To the bit: as texts that show the sign of a zero."""
    assert list(map(repr, sorted(found.items()))) == list(map(repr, sorted(expected.items())))


TARGETS = [["-O0"], ["-O1"], ["-O", "reference"], ["--target", "c", "-O0"], ["--target", "c"]]


def recorded(program: Path, name: Path | str, *options: str) -> None:
    if "c" in options:
        try:
            find_compiler()
        except CompilerError as problem:
            pytest.skip(str(problem))
    assert main(["run", str(program), "--for", "100ms", "--quiet", "--record", str(name), *options]) == 0


@pytest.mark.parametrize("options", TARGETS, ids=" ".join)
def test_mcap_reads_the_values_of_the_run(program: Path, run: Run, options: list[str], tmp_path: Path) -> None:
    recorded(program, tmp_path / "run.mcap", *options)
    equal(by_mcap(tmp_path / "run.mcap"), seen_by_run(run, names_of_literals=False))
    assert [path.name for path in tmp_path.iterdir()] == ["run.mcap"]


def test_messages_as_json_have_names_of_literals_and_shortest_numbers(program: Path, run: Run, tmp_path: Path) -> None:
    recorded(program, tmp_path / "run.mcap", "--messages", "json")
    equal(by_mcap(tmp_path / "run.mcap"), seen_by_run(run, names_of_literals=True))


def test_rosbags_reads_the_values_of_the_run(program: Path, run: Run, tmp_path: Path) -> None:
    recorded(program, f"{tmp_path}/bag/")
    ports = [port.name for port in run.network.external_ports]
    seen = by_rosbags(tmp_path / "bag", dict(zip(topics(ports), ports, strict=True)))
    equal(seen, seen_by_run(run, names_of_literals=False))
    assert [path.name for path in tmp_path.iterdir()] == ["bag"]


@pytest.mark.parametrize("options", [[], ["--target", "c"]], ids=" ".join)
def test_pyarrow_reads_the_values_of_the_run(program: Path, run: Run, options: list[str], tmp_path: Path) -> None:
    recorded(program, tmp_path / "run.parquet", *options)
    columns = {port.name: [name for name, _, _ in leaves(port.name, port.type)] for port in run.network.external_ports}
    equal(by_pyarrow(tmp_path / "run.parquet", columns), seen_by_run(run, names_of_literals=True))
    assert [path.name for path in tmp_path.iterdir()] == ["run.parquet"]


@pytest.mark.parametrize("options", [*TARGETS, ["--trace", "trace.jsonl"]], ids=" ".join)
def test_a_table_and_an_archive_are_those_of_the_whole_run(
    program: Path, run: Run, options: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    recorded(program, "run.csv", *options)
    assert Path("run.csv").read_text() == "".join(csv_parts(run))
    recorded(program, "run.npz", *options)
    run.to_npz("whole.npz")
    streamed, whole = numpy.load("run.npz"), numpy.load("whole.npz")
    assert sorted(streamed) == sorted(whole)
    for name in whole:
        assert streamed[name].dtype == whole[name].dtype
        assert streamed[name].tobytes() == whole[name].tobytes()


def test_instants_are_the_nearest_seconds_in_every_format(program: Path, run: Run, tmp_path: Path) -> None:
    recorded(program, tmp_path / "run.csv")
    recorded(program, tmp_path / "run.npz")
    instants = numpy.load(tmp_path / "run.npz")["speed.time"].tolist()
    assert instants == [tick / 1000 for tick in range(1, len(instants) + 1)]
    assert run.time("speed").tolist() == instants
    rows = (tmp_path / "run.csv").read_text().splitlines()[1:]
    assert {row.partition(",")[0] for row in rows} >= {repr(instant) for instant in instants}


def test_units_types_and_periods_are_in_the_metadata(program: Path, tmp_path: Path) -> None:
    from mcap.reader import make_reader
    from pyarrow import parquet

    recorded(program, tmp_path / "run.mcap")
    with open(tmp_path / "run.mcap", "rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    channels = {channel.metadata["port"]: channel.metadata for channel in summary.channels.values()}
    assert channels["gyro"]["type"] == "float[3]"
    assert (channels["gyro"]["period"], channels["gyro"]["offset"]) == ("2000000", "0")
    assert channels["speed"]["unit"] == "rad/s"
    assert "period" not in channels["button"]
    recorded(program, tmp_path / "run.parquet")
    schema = parquet.read_schema(tmp_path / "run.parquet")
    assert schema.field("power").metadata == {b"type": b"double<W>", b"unit": b"W"}
    assert schema.field("late").metadata == {b"type": b"time", b"unit": b"ns"}


def test_a_value_that_is_written_twice_at_an_instant_is_there_twice(program: Path, tmp_path: Path) -> None:
    recorded(program, tmp_path / "run.mcap")
    seen = by_mcap(tmp_path / "run.mcap")["seen"]
    assert seen[0][0] == seen[1][0]
    assert [value for _, (value,) in seen[:2]] == [True, False]


def test_what_was_there_is_replaced_only_by_a_whole_recording(program: Path, tmp_path: Path) -> None:
    name = tmp_path / "run.csv"
    name.write_text("before\n")
    name.chmod(0o640)
    assert main(["run", str(program), "--record", str(name), "--environment", "None"]) == 2
    assert name.read_text() == "before\n"
    recorded(program, name)
    assert next(csv.reader(io.StringIO(name.read_text())))[0] == "time"
    assert name.stat().st_mode & 0o777 == 0o640


def test_a_bag_is_not_overwritten(program: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "bag").mkdir()
    assert main(["run", str(program), "--record", f"{tmp_path}/bag/"]) == 2
    assert "a bag is not overwritten" in capsys.readouterr().err


def test_parquet_without_pyarrow_says_how_to_install_it(
    program: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from cspdiag.simulate.record.streamed import formats

    monkeypatch.setattr(formats, "find_spec", lambda name: None)
    assert main(["run", str(program), "--record", str(tmp_path / "run.parquet")]) == 2
    assert "pip install 'cspdiag[parquet]'" in capsys.readouterr().err


def test_json_schemas_describe_every_type(run: Run) -> None:
    from cspdiag.simulate.record.streamed.mcap.json_messages import json_schema

    schemas: dict[str, Any] = {port.name: json.loads(json_schema(port.type)) for port in run.network.external_ports}
    assert schemas["speed"]["properties"]["value"] == {"type": "number", "description": "rad/s"}
    assert schemas["button"]["properties"]["value"]["enum"] == ["idle", "tooHot", "done"]
    assert schemas["pose"]["properties"]["tauD"] == {"type": "number", "description": "s"}
    kinds = {kind.__class__ for port in run.network.external_ports for _, kind, _ in leaves("", port.type)}
    assert BoolType in kinds
