"""A run with the inputs of a recording has the trace of the run that was recorded, on every target."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cspdiag.cli.main import main
from cspdiag.simulate.native.build import CompilerError, find_compiler
from tests.simulate.record.streamed.test_formats import PROGRAM

TARGETS = [["-O0"], ["-O1"], ["-O", "reference"], ["--target", "c"], ["--target", "c", "-O0"]]

EVENTS = """
process Slow {
  in  button : int
  in  level  : double @ 2 ms
  out seen   : int
  communication {
    var m : int = 0
    var v : double = 0
  }
  composition { mu (button ? m ; seen ! m ; wait 2500 us ; level ? v ; wait 700 us) }
}

process Both {
  in  button : int
  in  level  : double @ 2 ms
  out first  : int
  out second : int
  communication {
    a : Taker(pause = 100 us)
    b : Taker(pause = 3300 us)
    button -> broadcast -> a.button, b.button
    a.seen -> first
    b.seen -> second
    level -> _
  }
  composition { a || b }
}

process Taker(pause: time) {
  in  button : int
  out seen   : int
  communication { var m : int = 0 }
  composition { mu (button ? m ; seen ! m ; wait pause) }
}

submodel Finger {
  out button : int
  out level  : double
  state n : int = 0
  next n = n + 1
  // It returns to values that were taken, by way of others that were not.
  button = if n % 3 == 1 then 5 else if n % 7 == 0 then 6 else 4
  level = time / 1<s>
}

environment Hand for Slow step 1 ms on miss count {
  finger : Finger
  finger.button -> button
  finger.level -> level
  seen -> _
}

environment Hands for Both step 1 ms on miss count {
  finger : Finger
  finger.button -> button
  finger.level -> level
  first -> _
  second -> _
}
"""

OTHER = """
process Drive {
  in  speed : double<CHANGED> @ PERIOD
  in  MORE : double @ 1 ms
  out power : double @ 1 ms
  communication {
    var v : double<CHANGED>
    MORE -> _
  }
  composition { mu (speed ? v ; power ! 0) }
}
environment Bench for Drive {
  power -> _
  plant : Plant
  plant.speed -> speed
  plant.MORE -> MORE
}
submodel Plant { out speed : double<CHANGED>  out MORE : double  speed = 0<CHANGED>  MORE = 0 }
"""


def run(program: Path, *options: str) -> int:
    if "c" in options:
        try:
            find_compiler()
        except CompilerError as problem:
            pytest.skip(str(problem))
    return main(["run", str(program), "--quiet", *options])


def trace(path: Path) -> list[str]:
    return [row for row in path.read_text().splitlines() if json.loads(row)]


@pytest.mark.parametrize("options", TARGETS, ids=" ".join)
@pytest.mark.parametrize(
    ("text", "environment"),
    [(PROGRAM, "Bench"), (EVENTS, "Hand"), (EVENTS, "Hands")],
    ids=["types", "sync", "broadcast"],
)
def test_the_trace_is_the_same(tmp_path: Path, text: str, environment: str, options: list[str]) -> None:
    program, first, again = tmp_path / "main.csp", tmp_path / "first.jsonl", tmp_path / "again.jsonl"
    program.write_text(text)
    recording = tmp_path / "run.mcap"
    chosen = ["--environment", environment]
    assert run(program, *chosen, "--for", "90ms", "--record", str(recording), "--trace", str(first), "-O0") == 0
    # Nothing of the environment is left but its ports.
    program.write_text(text.replace("sin(time", "cos(time").replace("n % 3", "n % 5"))
    assert run(program, *chosen, "--inputs", str(recording), "--trace", str(again), *options) == 0
    assert trace(again) == trace(first)
    assert len(trace(first)) > 10


@pytest.mark.parametrize("name", ["run.npz", "run.parquet", "bag/", "run.csv"])
def test_any_format_has_inputs(tmp_path: Path, name: str) -> None:
    program, first, again = tmp_path / "main.csp", tmp_path / "first.jsonl", tmp_path / "again.jsonl"
    program.write_text(PROGRAM)
    recording = f"{tmp_path}/{name}"
    assert run(program, "--for", "90ms", "--record", recording, "--trace", str(first)) == 0
    assert run(program, "--inputs", recording, "--trace", str(again)) == 0
    assert trace(again) == trace(first)


@pytest.mark.parametrize(
    ("changed", "period", "more", "reason"),
    [
        ("rad/s", "1 ms", "speed2", "has no signal for the input `speed2` (other.csp:4)"),
        ("deg/s", "1 ms", "late", "speed is a double<rad/s>, and the input `speed` (other.csp:3) a double<deg/s>"),
        (
            "rad/s",
            "2 ms",
            "late",
            "speed has a sample every 1 ms, and the input `speed` (other.csp:3) a sample every 2 ms",
        ),
        ("rad/s", "1 ms", "small", "small is a int8, and the input `small` (other.csp:4) a double"),
    ],
)
def test_a_recording_that_does_not_fit_is_refused(
    tmp_path: Path, changed: str, period: str, more: str, reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    program, other = tmp_path / "main.csp", tmp_path / "other.csp"
    program.write_text(PROGRAM)
    other.write_text(OTHER.replace("CHANGED", changed).replace("PERIOD", period).replace("MORE", more))
    recording = tmp_path / "run.mcap"
    assert run(program, "--for", "20ms", "--record", str(recording)) == 0
    assert run(other, "--inputs", str(recording)) == 1
    assert reason in capsys.readouterr().err.replace(f"{tmp_path}/", "")


def test_a_table_without_a_column_for_an_input_is_refused_with_those_that_it_has(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program, table = tmp_path / "main.csp", tmp_path / "other.csv"
    program.write_text(PROGRAM)
    table.write_text("time,level,valve\n0.001,1,2\n")
    assert run(program, "--inputs", str(table)) == 1
    assert "; it has: level, valve" in capsys.readouterr().err


def test_a_run_ends_where_its_inputs_end(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, recording = tmp_path / "main.csp", tmp_path / "run.mcap"
    program.write_text(PROGRAM)
    assert run(program, "--for", "20ms", "--record", str(recording)) == 0
    assert run(program, "--inputs", str(recording), "--for", "30ms") == 2
    assert "ends at 20 ms, before --for 30 ms" in capsys.readouterr().err
    data = recording.read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(data[: data.index(b"cspdiag.end")])
    assert main(["run", str(program), "--inputs", str(cut)]) == 0
    shown = capsys.readouterr().err
    assert "was cut off: its inputs end at 20 ms" in shown
    assert "reached the time limit at 20 ms" in shown


def test_a_value_between_samples_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, table = tmp_path / "main.csp", tmp_path / "inputs.csv"
    program.write_text(
        "process Main {\n  in slow : int @ 7 ms\n  communication { var v : int }\n  composition { mu slow ? v }\n}\n"
    )
    table.write_text("time,slow\n0.001,1\n0.007,7\n0.008,8\n0.014,8\n")
    assert main(["run", str(program), "--inputs", str(table)]) != 0
    expected = f"has a value at 1 ms for the input `slow` ({program}:2), which has a sample every 7 ms, not then"
    assert expected in capsys.readouterr().err


def test_a_missing_sample_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, recording = tmp_path / "main.csp", tmp_path / "run.csv"
    program.write_text(PROGRAM)
    assert run(program, "--for", "20ms", "--record", str(recording)) == 0
    rows = recording.read_text().splitlines(keepends=True)
    recording.write_text("".join(row for row in rows if not row.startswith("0.011,")))
    assert run(program, "--inputs", str(recording)) == 1
    assert "has no sample at 11 ms for the input `speed` (main.csp:7), a sample every 1 ms" in (
        capsys.readouterr().err.replace(f"{tmp_path}/", "")
    )


@pytest.mark.parametrize("option", [["--real-time"], ["--on", "cortex-m4", "--target", "c"]], ids=" ".join)
def test_what_has_a_time_of_its_own_is_refused(
    tmp_path: Path, option: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "main.csp"
    program.write_text(PROGRAM)
    assert run(program, "--inputs", str(tmp_path / "run.mcap"), *option) == 2
    assert f"--inputs is not for {option[0]}" in capsys.readouterr().err


ALONE = """\
enum Mode { off, on }
struct Pose { x: double  n: int }
process Main {
  in  level : double @ 10 ms
  in  stop  : bool
  in  pose  : Pose @ 20 ms
  in  mode  : Mode @ 20 ms
  in  gyro  : double[2] @ 20 ms
  out seen  : double @ 10 ms
  communication {
    a : Loop
    b : Other

    level  -> a.level
    stop   -> a.stop
    a.seen -> seen
    pose   -> b.pose
    mode   -> b.mode
    gyro   -> b.gyro
  }
  composition { a || b }
}
process Loop {
  in  level : double @ 10 ms
  in  stop  : bool
  out seen  : double @ 10 ms
  communication { var x : double = 0  var s : bool = false }
  composition { mu (stop ? s -> skip []> level ? x -> seen ! (if s then -x else x)) }
}
process Other {
  in  pose  : Pose @ 20 ms
  in  mode  : Mode @ 20 ms
  in  gyro  : double[2] @ 20 ms
  communication {
    var p : Pose      = Pose(x = 0, n = 0)
    var m : Mode      = Mode.off
    var g : double[2] = [0, 0]
  }
  composition { mu (pose ? p || mode ? m || gyro ? g) }
}
"""
ITS_ENVIRONMENT = """
submodel Plant {
  in seen : double
  out level : double
  out stop : bool
  out pose : Pose
  out mode : Mode
  out gyro : double[2]
  level = time / 1<s>
  stop = time > 55 ms and time < 95 ms
  pose = Pose(x = seen, n = 3)
  mode = if time > 50 ms then Mode.on else Mode.off
  gyro = [level, 2]
}
environment Bench for Main {
  plant : Plant
  seen        -> plant.seen
  plant.level -> level
  plant.stop  -> stop
  plant.pose  -> pose
  plant.mode  -> mode
  plant.gyro  -> gyro
}
"""


def test_a_program_without_an_environment_has_the_trace_of_a_recorded_run_as_well(tmp_path: Path) -> None:
    alone, whole = tmp_path / "alone.csp", tmp_path / "whole.csp"
    alone.write_text(ALONE)
    whole.write_text(ALONE + ITS_ENVIRONMENT)
    recorded, again, expected = (str(tmp_path / name) for name in ("run.mcap", "again.csv", "expected.csv"))
    assert main(["run", str(whole), "--for", "200ms", "--record", recorded]) == 0
    assert main(["show", recorded, "--save", expected]) == 0
    for target in TARGETS:
        try:
            find_compiler()
        except CompilerError:
            if "c" in target:
                continue
        assert main(["run", str(alone), *target, "--inputs", recorded, "--record", again]) == 0
        assert Path(again).read_bytes() == Path(expected).read_bytes(), target


def test_a_program_without_ports_has_no_inputs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, recorded = tmp_path / "main.csp", tmp_path / "run.csv"
    program.write_text("process Main { composition { skip } }\n")
    recorded.write_text("time,level\n0.01,1\n")
    assert main(["run", str(program), "--inputs", str(recorded)]) == 2
    assert "--inputs: a recording is for programs with ports: this one has none" in capsys.readouterr().err
