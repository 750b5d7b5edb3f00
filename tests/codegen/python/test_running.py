"""Generated packages run: the compositions do what they say, and ``python -m`` reports it."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from cspdiag.runtime import Observer, Outcome, ms
from cspdiag.simulate.run.package import LoadedPackage
from tests.codegen.packages import network, package

Trace = list[tuple[int, str, Any]]


class Watcher(Observer):
    """Records the communications of a run."""

    def __init__(self) -> None:
        self.trace: Trace = []

    def communication(self, time: int, channel: str, value: object, writer: str, reader: str) -> None:
        self.trace.append((time, channel, value))


@contextmanager
def loaded(name: str) -> Iterator[LoadedPackage]:
    made = LoadedPackage(network(name).name, package(name))
    try:
        yield made
    finally:
        made.close()


def ran(name: str) -> tuple[Outcome, Trace, Any]:
    watcher = Watcher()
    with loaded(name) as made:
        environments = made.module("environments").ENVIRONMENTS
        environment = next(iter(environments.values()))() if environments else None
        running = made.module("network").build(environment.drivers if environment else {})
        outcome = running.run(environment=environment, until=1000 * ms, observer=watcher)
        return outcome, watcher.trace, environment


def values(trace: Trace, channel: str) -> list[Any]:
    return [value for _, name, value in trace if name == channel]


def test_numbers_go_round_a_ring_of_processes() -> None:
    _, trace, _ = ran("hand_commstime")
    assert values(trace, "Commstime.c")[:101] == list(range(101))


def test_replicated_branches_each_have_their_index() -> None:
    outcome, trace, _ = ran("parallel")
    assert outcome.ended == "terminated"
    for index in range(6):
        assert values(trace, f"Line.pool.pool.task[{index}]") == [index + 1, 0]
        assert values(trace, f"Line.pool.worker[{index}].result") == [(index + 1) * index, 0]
    assert values(trace, "Line.total") == [70]
    assert values(trace, "Line.teller.news") == [0, 0, 1, 1, 4, 4, 9, 9]


def test_bodies_written_by_hand_take_part() -> None:
    outcome, trace, environment = ran("hardware")
    assert outcome.ended == "terminated"
    assert values(trace, "Machine.lamp") == [value for port, value in environment.panel.written if port == "lamp"][:-1]
    x, total = 1.0, 0.0
    for level, angle in zip(values(trace, "Machine.level"), values(trace, "Machine.angle"), strict=True):
        x += angle
        total += 4 * x + 0.5
        assert level == pytest.approx(4 * x + 0.5 + total)


def test_a_deadlock_names_the_lines_of_the_program() -> None:
    outcome, _, _ = ran("hand_commstime")
    assert outcome.deadlock is not None
    assert "Commstime.prefix waits to write Commstime.a (hand.csp:11)" in outcome.deadlock.text


def test_a_package_runs_by_itself(tmp_path: Path) -> None:
    for path, text in package("buffer").items():
        target = tmp_path / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
    command = [sys.executable, "-I", "-c", f"import sys; sys.path.insert(0, {str(tmp_path)!r}); import runpy; "
               "sys.argv[1:] = ['--for', '1s']; runpy.run_module('buffer', run_name='__main__')"]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "ended by itself" in done.stdout


def test_types_whose_names_python_has_for_other_things_have_values() -> None:
    _, trace, _ = ran("members")
    assert [tuple(value) for value in values(trace, "Process.s")] == [(1.0, 2, 3, 4, 5, 6, 7, 8)]
    assert values(trace, "Process._x") == [0.0, 0.0]
