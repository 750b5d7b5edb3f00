"""``cspdiag run --tune``: parameters that change while a program runs."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Command

PROGRAM = """parameter k : double = 1
struct Gains { kp: double  ti: time }
parameter gains : Gains = Gains(kp = 2, ti = 10 ms)
const T = 10 ms
const twice = 2 * k

process Main {
  out y : double
  out t : time
  composition { mu (y ! twice * gains.kp ; t ! gains.ti ; wait T) }
}

environment World for Main { y -> _  t -> _ }
"""


@pytest.fixture
def program(tmp_path: Path) -> Path:
    file = tmp_path / "main.csp"
    file.write_text(PROGRAM, encoding="utf-8")
    return file


def traced(cspdiag: Command, program: Path, changes: str, *options: str) -> tuple[list[tuple[int, str, float]], str]:
    """The trace of 50 ms, and what was said."""
    (program.parent / "changes.txt").write_text(changes, encoding="utf-8")
    trace = program.parent / "trace.jsonl"
    done = cspdiag(
        "run", program, "--for", "45ms", "--quiet", "--tune", program.parent / "changes.txt", "--trace", trace, *options
    )
    assert done.code == 0, done.err
    lines = [json.loads(line) for line in trace.read_text(encoding="utf-8").splitlines()]
    return [(line["t"] // 1_000_000, line["channel"], line["value"]) for line in lines], done.err


@pytest.mark.parametrize("options", [(), ("-O0",), ("-O", "reference"), ("--target", "c")], ids=str)
def test_changes_take_effect_between_two_instants(cspdiag: Command, program: Path, options: tuple[str, ...]) -> None:
    trace, said = traced(
        cspdiag, program, "gains.kp = 3\nat 20 ms k = 5 # five\n\nat 20.5ms gains.ti = 1 s\n", *options
    )
    assert [value for _, channel, value in trace if channel == "Main.y"] == [6, 6, 30, 30, 30]
    assert [value for _, channel, value in trace if channel == "Main.t"] == [10_000_000] * 3 + [1_000_000_000] * 2
    assert said == ""


def test_a_wrong_line_is_reported_and_the_run_continues(cspdiag: Command, program: Path) -> None:
    trace, said = traced(
        cspdiag,
        program,
        "k\ntwice = 3\nT = 2 ms\nat 10 ms q = 1\nk = fast\nat 20 ms k = 2\ngains = 3\n"
        "at -1 ms k = 4\nat 5 k = 3\ngains.kq = 3\n",
    )
    assert [value for _, channel, value in trace if channel == "Main.y"] == [4, 4, 8, 8, 8]
    assert [line.partition(": ")[2] for line in said.splitlines()] == [
        "--tune, line 1: a setting is NAME=VALUE, not 'k'",
        "--tune, line 2: twice does not change by itself while the program runs: it follows from parameters",
        "--tune, line 3: T does not change by itself while the program runs: it is a constant, which --set can set "
        "before",
        "--tune, line 4: there is no parameter 'q' of the program (the parameters are k, gains)",
        "--tune, line 5: k: `fast` is not of type double",
        "--tune, line 7: gains: Gains is a struct; set its fields: gains.kp, gains.ti",
        "--tune, line 8: k=4: a run has no instant -1 ms: it begins at 0 s",
        "--tune, line 9: a change at an instant is at TIME NAME=VALUE, such as at 2 s gain=3, not 'at 5 k = 3'",
        "--tune, line 10: there is no parameter 'gains.kq' (Gains has the fields kp, ti)",
    ]


@pytest.mark.parametrize("kind", ["int", "double"])
@pytest.mark.parametrize("options", [("-O0",), ("-O1",), ("-O", "reference"), ("--target", "c")], ids=str)
def test_a_change_that_makes_no_sense_is_refused(
    cspdiag: Command, tmp_path: Path, options: tuple[str, ...], kind: str
) -> None:
    program = tmp_path / "main.csp"
    program.write_text(
        f"parameter n : {kind} = 1\nconst share = 12 / n\n"
        f"process Main {{ out y : {kind} composition {{ mu (y ! share ; wait 10 ms) }} }}\n"
        "environment World for Main { y -> _ }\n",
        encoding="utf-8",
    )
    trace, said = traced(cspdiag, program, "at 10 ms n = 0\nat 20 ms n = 3\n", *options)
    assert [value for _, _, value in trace] == [12, 12, 4, 4, 4]
    assert "n was not changed at 10 ms: division by zero" in said


def test_a_program_without_parameters(cspdiag: Command, tmp_path: Path) -> None:
    program = tmp_path / "main.csp"
    program.write_text("process Main { out y : int composition { y ! 1 } }\n", encoding="utf-8")
    done = cspdiag("run", program, "--tune", tmp_path / "none.txt")
    assert done.code == 2
    assert "write `parameter` instead of `const`" in done.err


@pytest.mark.parametrize("options", [[], ["--target", "c"]], ids=" ".join)
def test_in_real_time_lines_take_effect_as_they_come(program: Path, options: list[str]) -> None:
    trace = program.parent / "trace.jsonl"
    command = [sys.executable, "-m", "cspdiag", "run", str(program), "--for", "1s", "--real-time", "--quiet"]
    command += ["--tune", "--trace", str(trace), *options]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stderr=pipe, text=True) as running:
        assert running.stdin is not None
        assert running.stderr is not None
        running.stdin.write("at 400 ms k = 5\nk = fast\nk = 4\n")
        running.stdin.flush()
        running.stdin.close()
        said = running.stderr.read()
        assert running.wait(20) == 0
    assert "--tune, line 2: k: `fast` is not of type double" in said
    lines = [json.loads(line) for line in trace.read_text(encoding="utf-8").splitlines()]
    values = [line["value"] for line in lines if line["channel"] == "Main.y"]
    assert set(values) <= {4, 16, 20}
    assert values == sorted(values)
    assert values[-1] == 20
    assert next(line["t"] for line in lines if line["value"] == 20) >= 400_000_000
