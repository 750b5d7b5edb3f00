"""The hint that simulated time stands still."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from cspdiag.cli.main import main
from cspdiag.cli.support.runs.standstill import ObservedProgram, ProgramInPlace, Standstill
from cspdiag.runtime.deadlock.partners import report_deadlock
from cspdiag.runtime.deadlock.reports import DeadlockReport
from cspdiag.runtime.kernel.scheduler import Task
from cspdiag.simulate.hosts.links import PATIENCE
from cspdiag.simulate.hosts.run import DividedNetwork
from cspdiag.simulate.record.recorder import Recorder


class _Clock:
    """Stays at one instant, or advances by a nanosecond at each check; signals when it was checked that often."""

    def __init__(self, step: int, checks: int, awaited: str = "", *, over: bool = False) -> None:
        self.step = step
        self.over = over
        self.awaited = awaited
        self.left = checks
        self.seen = threading.Event()
        self._now = 2_000_000_000

    @property
    def now(self) -> int:
        self._now += self.step
        self.left -= 1
        if self.left == 0:
            self.seen.set()
        return self._now

    def running_processes(self) -> list[str]:
        return []


def _recorder(*names: str) -> Recorder:
    recorder = Recorder()
    for name in ("Top", *(f"Top.{name}" for name in names)):
        recorder.process_started(0, name, "N")
    return recorder


def test_a_standstill_is_reported_once_with_what_runs(capsys: pytest.CaptureFixture[str]) -> None:
    with Standstill(_recorder("c[0]", "c[1]", "c[2]", "c[3]", "c[4]"), "Top", patience=0.001) as standstill:
        standstill.attach(_Clock(step=0, checks=2))
        standstill.thread.join()
    reported = capsys.readouterr().err
    assert reported.startswith(
        "cspdiag: simulated time stands still at 2 s, with c[0], c[1], c[2], c[3] and 1 more running: "
    )
    assert "assert Top livelock free" in reported
    assert reported.count("\n") == 1


def test_who_waits_for_another_place_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    with Standstill(_recorder("c"), "Top", patience=0.001) as standstill:
        standstill.attach(ProgramInPlace(_Clock(step=0, checks=2, awaited="right")))
        standstill.thread.join()
    assert capsys.readouterr().err == "cspdiag: simulated time stands still at 2 s, waiting for the place `right`\n"


def test_a_place_that_answers_all_the_time_is_not_waited_for() -> None:
    network = object.__new__(DividedNetwork)
    network._awaited, network._awaited_since = "", 0.0
    for _ in range(3):
        network.wait_for("right")
        assert network.awaited == ""
        network.wait_for("")
    network.wait_for("right")
    network._awaited_since -= 2 * PATIENCE
    network.wait_for("right")
    assert network.awaited == "right"


def test_an_fmu_that_may_compute_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    with Standstill(_recorder("c"), "Top", ["Slow.fmu"], patience=0.001) as standstill:
        standstill.attach(_Clock(step=0, checks=2))
        standstill.thread.join()
    assert capsys.readouterr().err == (
        "cspdiag: simulated time stands still at 2 s: no process is at work, so perhaps Slow.fmu: Ctrl-C ends the run\n"
    )


def test_nothing_is_reported_while_time_advances(capsys: pytest.CaptureFixture[str]) -> None:
    clock = _Clock(step=1, checks=5)
    with Standstill(_recorder("c"), "Top", patience=0.001) as standstill:
        standstill.attach(clock)
        assert clock.seen.wait(60)
    assert capsys.readouterr().err == ""


def test_a_run_that_does_not_begin_is_left_alone(capsys: pytest.CaptureFixture[str]) -> None:
    with Standstill(_recorder(), "Top"):
        pass
    assert capsys.readouterr().err == ""


def test_nothing_is_reported_of_a_run_that_is_over(capsys: pytest.CaptureFixture[str]) -> None:
    with Standstill(_recorder("c"), "Top", patience=0.001) as standstill:
        standstill.attach(_Clock(step=0, checks=2, over=True))
        standstill.thread.join()
    assert capsys.readouterr().err == ""


STUCK = """process Main {
  communication { var n : int = 0 }
  composition { wait 1 ms ; stop }
}
environment E for Main {}
"""


@pytest.mark.parametrize("level", ["-O0", "-O1"])
def test_a_run_is_over_while_its_deadlock_is_reported(
    level: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    observed = []

    def report(root: Task, time: int) -> DeadlockReport:
        assert program is not None
        observed.append(program.over)
        return report_deadlock(root, time)

    program: ObservedProgram | None = None

    def attach(_: Standstill, running: ObservedProgram) -> None:
        nonlocal program
        program = running
        observed.append(program.over)

    monkeypatch.setattr("cspdiag.runtime.advance.run.report_deadlock", report)
    monkeypatch.setattr(Standstill, "attach", attach)
    path = tmp_path / "stuck.csp"
    path.write_text(STUCK)
    assert main(["run", level, str(path)]) == 1
    assert "deadlock at 1 ms" in capsys.readouterr().err
    assert observed == [False, True]


STANDS = """submodel Law { in x : double  out y : double  y = 2 * x }
process Main {
  in p : double @ 10 ms
  communication {
    a : Law
    var n : int = 0
    p -> a.x
    a.y -> _
  }
  composition {
    (mu (n := 1 - n) until n > 3) || mu a
  }
}
submodel Source { out p : double  p = 1 }
environment Bench for Main step 5 ms { source : Source  source.p -> p }
"""


SPINS = """process Ping { out o : int  composition { mu o ! 1 } }
process Pong {
  in i : int
  communication { var v : int }
  composition { mu i ? v }
}
process Main {
  communication { ping : Ping  pong : Pong  ping.o -> pong.i }
  composition {
    wait 7 ms ; (ping || pong)
  }
}
"""


RUN = """
import runpy
from cspdiag.cli.support.runs import standstill
standstill.PATIENCE = 1.0
runpy.run_module("cspdiag", run_name="__main__", alter_sys=True)
"""
"""``python -m cspdiag``, which reports a standstill sooner: until then programs compute."""


def _stopped_at_standstill(text: str, tmp_path: Path, *options: str) -> tuple[str, str]:
    """What a run reports about the standstill, and, after Ctrl-C, about how it has ended."""
    program = tmp_path / "stands.csp"
    program.write_text(text)
    command = [sys.executable, "-c", RUN, "run", *options, str(program)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        reported = next(line for line in running.stderr if "stands still" in line)
        running.send_signal(signal.SIGINT)
        _, ended = running.communicate()
    return reported, ended


@pytest.mark.parametrize("options", [("-O0",), ("-O1",), ("--target", "c", "-O0"), ("--target", "c", "-O1")])
def test_process_and_line_are_named_of_a_loop_in_which_time_stands_still(
    options: tuple[str, ...], tmp_path: Path
) -> None:
    reported, ended = _stopped_at_standstill(STANDS, tmp_path, *options)
    assert "stands still at 0 s" in reported
    assert "Main (stands.csp:11)" in reported
    assert re.search(r"simulated 0 s in [1-9][0-9.]* s", ended)


def test_instant_and_partners_of_an_endless_native_program_are_named(tmp_path: Path) -> None:
    reported, ended = _stopped_at_standstill(SPINS, tmp_path, "--target", "c", "-O0")
    assert "stands still at 0.007 s, with ping, pong running; at work: " in reported
    assert re.search(r"Main\.(ping \(last waited at stands.csp:1\)|pong \(last waited at stands.csp:5\))", reported)
    assert "stopped by SIGINT at 7 ms" in ended
    assert re.search(r"simulated 7 ms in [1-9][0-9.]* s", ended)


COUNTS = """process Main {
  out r : int
  communication {
    var n : int = 0
    var m : int8 = 0
  }
  composition {
    mu (r ! n ; n := n + 1 ; wait 1 ms) until n == 3 ;
    mu (m := 1 - m SPIN) until m > 3 ; r ! 4
  }
}
environment Bench for Main { r -> _ }
"""


@pytest.mark.parametrize(
    ("spin", "options"),
    [
        ("", ("-O0",)),
        ("", ("-O1",)),
        ("", ("--target", "c")),
        ("; (after 0 ms -> skip)", ("--target", "c", "-O0")),
    ],
    ids=["python", "optimized", "c", "timers"],
)
def test_what_was_written_before_time_stood_still_is_in_trace_and_recording(
    spin: str, options: tuple[str, ...], tmp_path: Path
) -> None:
    """A native program has reported everything that happened even if it has to be killed; the line is that of
    the loop.
    """
    trace, recording = tmp_path / "run.jsonl", tmp_path / "run.csv"
    outputs = ("--trace", str(trace), "--record", str(recording))
    reported, _ = _stopped_at_standstill(COUNTS.replace("SPIN", spin), tmp_path, *options, *outputs)
    # A delay that ends immediately is not a place where it has waited.
    line = 8 if "after" in spin else 9
    assert re.findall(r"stands\.csp:\d+", reported) == [f"stands.csp:{line}"]
    communications = [json.loads(line) for line in trace.read_text().splitlines()]
    assert [(entry["t"], entry["channel"], entry["value"]) for entry in communications if "channel" in entry] == [
        (0, "Main.r", 0), (1_000_000, "Main.r", 1), (2_000_000, "Main.r", 2)
    ]  # fmt: skip
    assert recording.read_text().splitlines()[:4] == ["time,r", "0.0,0", "0.001,1", "0.002,2"]


INSIDE = """process Spinner {
  communication { var n : int8 = 0 }
  composition { mu (n := 1 - n) until n > 3 }
}
process Idle { composition { mu wait 5 ms } }
process Main {
  communication { spinner : Spinner  idle : Idle }
  composition { spinner || idle }
}
environment Bench for Main { }
"""


def test_a_native_process_that_is_stopped_in_a_step_has_not_ended(tmp_path: Path) -> None:
    reported, ended = _stopped_at_standstill(INSIDE, tmp_path, "--target", "c")
    assert "with spinner running" in reported
    assert "  spinner: spinner running\n" in ended
