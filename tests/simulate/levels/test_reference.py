"""``cspdiag run -O reference``: the reference semantics does what the readable code does."""

from __future__ import annotations

import signal
import sys
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.cli.main import main
from cspdiag.network.ir.network import Network
from cspdiag.runtime.kernel.stopping import stopping
from cspdiag.semantics.execute import has_bodies_of_other_languages
from cspdiag.simulate.record.files import csv_parts, plain_trace_text
from cspdiag.simulate.record.recorder import Recorder
from cspdiag.simulate.result import Run
from cspdiag.simulate.run import execute, reference
from tests.conformance.sources import MODELS, environments, network_of, read

LIMIT = 100_000_000


def on_readable_code(network: Network, environment: str | None) -> Run:
    files = pipeline.generate(network, read, level=0, traced=True, observed=True)
    return execute.simulate(network, files, environment=environment, until=LIMIT)


class Stopping(Recorder):
    """Sends the process a signal at the first communication."""

    def communication(self, time: int, channel: str, value: object, writer: str, reader: str) -> None:
        super().communication(time, channel, value, writer, reader)
        signal.raise_signal(signal.SIGTERM)


def account(run: Run) -> list[str]:
    """The summary without the duration of the run."""
    first, _, *rest = run.summary().splitlines()
    return [first, *rest]


@pytest.mark.parametrize("name", MODELS)
def test_every_model_runs_as_its_readable_code(name: str) -> None:
    network = network_of(read(name))
    for environment in environments(network):
        if has_bodies_of_other_languages(network, environment):
            with pytest.raises(reference.NoMeaningError):
                reference.simulate(network, environment=environment, until=LIMIT, recorder=Recorder())
            continue
        run = reference.simulate(network, environment=environment, until=LIMIT, recorder=Recorder())
        expected = on_readable_code(network, environment)
        assert plain_trace_text(run) == plain_trace_text(expected)
        assert "".join(csv_parts(run)) == "".join(csv_parts(expected))
        assert account(run) == account(expected)
        assert run.outcome.exit_code == expected.outcome.exit_code


def program(tmp_path: Path, end: str) -> Path:
    path = tmp_path / "top.csp"
    path.write_text(
        f"exception Tired\n\nprocess Top {{\n  communication {{ var n : int = 0 }}\n"
        f"  composition {{ mu (n := n + 1 ; wait 1 ms ; if n == 3 then {end} else skip) }}\n}}\n",
        encoding="utf-8",
    )
    return path


@pytest.mark.parametrize("end", ["raise Tired", "n := 1 / (n - 3)", "stop"])
def test_endings_are_those_of_the_readable_code(tmp_path: Path, end: str) -> None:
    network = network_of(read(program(tmp_path, end).as_posix()))
    run = reference.simulate(network, environment=None, until=LIMIT, recorder=Recorder())
    expected = on_readable_code(network, None)
    assert account(run) == account(expected)
    assert run.outcome.ended == ("deadlock" if end == "stop" else "failed")


def test_signal_ends_the_run_with_what_was_recorded() -> None:
    network = network_of(read("models/buffer/buffer.csp"))
    recorder = Stopping()
    with stopping:
        run = reference.simulate(network, environment=None, until=LIMIT, recorder=recorder)
    assert (run.outcome.ended, run.outcome.signal) == ("stopped", signal.SIGTERM)
    assert len(run.communications) == 1
    assert all(activity.end is None for activity in run.activities)


class StoppingInside(Recorder):
    """Sends the process a signal when a process begins in another."""

    def process_started(self, time: int, path: str, kind: str) -> None:
        super().process_started(time, path, kind)
        if path == "Top.inner":
            signal.raise_signal(signal.SIGTERM)


@pytest.mark.parametrize("level", ["reference", 0, 1])
def test_processes_that_a_signal_stops_in_a_step_are_still_running(tmp_path: Path, level: int | str) -> None:
    path = tmp_path / "top.csp"
    path.write_text(
        "process Inner { communication { var n : int8 = 0 } composition { mu (n := 1 - n) until n > 3 } }\n"
        "process Top { communication { inner : Inner } composition { phase : (wait 1 ms ; inner) } }\n"
    )
    network = network_of(read(path.as_posix()))
    recorder = StoppingInside()
    with stopping:
        if isinstance(level, str):
            run = reference.simulate(network, environment=None, until=LIMIT, recorder=recorder)
        else:
            files = pipeline.generate(network, read, level=level, observed=True)
            run = execute.simulate(network, files, environment=None, until=LIMIT, recorder=recorder)
    assert (run.outcome.ended, run.outcome.signal) == ("stopped", signal.SIGTERM)
    assert {activity.path for activity in run.activities} == {"Top", "Top.phase", "Top.inner"}
    assert all(activity.end is None for activity in run.activities)


def test_deep_compositions_leave_the_interpreter_as_it_was(tmp_path: Path) -> None:
    network = network_of(read(program(tmp_path, "stop").as_posix()))
    before = sys.getrecursionlimit()
    reference.simulate(network, environment=None, until=LIMIT, recorder=Recorder())
    assert sys.getrecursionlimit() == before


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--real-time"], "--real-time is not for -O reference"),
        (["--target", "c"], "--target is not for -O reference"),
        (["--plot", "out.svg"], "--plot is not for -O reference"),
        (["--trace", "out.json"], "--trace FILE.jsonl has its trace"),
        (["--draw-deadlock", "out.svg"], "--draw-deadlock is not for -O reference"),
    ],
)
def test_bodies_unknown_to_the_reference_are_refused(
    heater: Path, options: list[str], reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", str(heater), "-O", "reference", *options]) == 2
    shown = capsys.readouterr().err
    assert reason in shown
    assert shown.count("\n") == 1


def test_bodies_in_other_languages_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "counter.py").write_text("class Counter:\n    pass\n", encoding="utf-8")
    path = tmp_path / "top.csp"
    path.write_text(
        'process Counter python "counter.py:Counter" { out n : int }\n'
        "process Top {\n  communication { counter : Counter var n : int = 0 counter.n -> n }\n"
        "  composition { counter }\n}\n",
        encoding="utf-8",
    )
    assert main(["run", str(path), "-O", "reference"]) == 2
    assert "`counter.py:Counter`, a body in another language: run it with -O0" in capsys.readouterr().err


def test_command_writes_the_trace_and_the_recording(heater: Path, tmp_path: Path) -> None:
    for level in (["-O0"], ["-O", "reference"]):
        trace, table = tmp_path / f"{level[-1]}.jsonl", tmp_path / f"{level[-1]}.csv"
        assert main(["run", str(heater), "--quiet", *level, "--trace", str(trace), "--record", str(table)]) == 0
    for ending in ("jsonl", "csv"):
        expected = (tmp_path / f"-O0.{ending}").read_text(encoding="utf-8")
        assert expected
        assert (tmp_path / f"reference.{ending}").read_text(encoding="utf-8") == expected


def test_missed_samples_are_named_as_by_the_readable_code() -> None:
    text = """
        process Main { in x : int @ 5 ms communication { var a : int } composition { mu (x ? a ; wait 12 ms) } }
        submodel S { out x : int state k : int = 0 next k = k + 1 x = k }
        environment E for Main on miss count { s : S s.x -> x }
    """
    network = network_of(SourceFile(name="case.csp", text=text))
    by_reference = reference.simulate(network, environment="E", until=LIMIT, recorder=Recorder())
    missed = by_reference.outcome.missed
    assert missed["Main.x"] > 0
    assert missed == on_readable_code(network, "E").outcome.missed


OUTSIDE = """
submodel S { out x : int state k : int = 5 next k = k - 1 x = k }
environment E for Main { s : S s.x -> x }
"""
FAILURES = {
    "a fault": (
        "process Main { in x : int @ 1 ms communication { var v : int }\n composition {\n mu (x ? v ;\n v := 1 / v) } }"
    ),
    "a fault in a condition": (
        "process Main { in x : int @ 1 ms communication { var v : int }\n"
        " composition { mu (\n x ? v) until\n 1 / v > 3 } }"
    ),
    "an exception of a process below": (
        "exception Oops\nprocess P { in x : int communication { var v : int } composition { x ? v ;\n raise Oops } }\n"
        "process Main { in x : int @ 1 ms communication { p : P x -> p.x } composition { p || stop } }"
    ),
    "a missed sample": (
        "process Main { in x : int @ 1 ms communication { var v : int } composition { x ? v ; wait 3 ms ;\n x ? v } }"
    ),
    "a law": (
        "submodel L {\n in x : int out y : int\n let a = x - 2\n y = 3 /\n a }\n"
        "process Main { in x : int @ 1 ms communication { l : L x -> l.x l.y -> _ } composition { mu l } }"
    ),
    "the environment": (
        "process Main { in x : int @ 1 ms communication { var v : int } composition { mu x ? v } }\n"
        "submodel T { in a : int out b : int\n b = 4 / (a - 1) }"
    ),
}


@pytest.mark.parametrize("failure", FAILURES)
def test_failures_have_the_places_that_the_readable_code_gives_them(failure: str) -> None:
    outside = OUTSIDE
    if failure == "the environment":
        outside = outside.replace("s.x -> x", "t : T s.x -> t.a t.b -> x")
    network = network_of(SourceFile(name="case.csp", text=FAILURES[failure] + outside))
    run = reference.simulate(network, environment="E", until=LIMIT, recorder=Recorder())
    assert run.outcome.ended == "failed"
    assert "case.csp:" in account(run)[0]
    assert account(run) == account(on_readable_code(network, "E"))
