"""Execution times that runs measure, and what the timing analysis does with them."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

import cspdiag
from cspdiag import pipeline
from cspdiag.analyses.timing.tasks.measured import Measured, times_of_laws
from cspdiag.base import SourceFile
from cspdiag.cli.verbs.verify_timing import measured_times
from cspdiag.network.ir.network import Network
from cspdiag.simulate.native import run as native
from cspdiag.simulate.result import Run
from cspdiag.simulate.run.execute import simulate
from tests.models.programs import MODELS

needs_compiler = pytest.mark.skipif(
    not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler: install gcc or clang"
)
LAWS = ("Cascade.inner.law", "Cascade.outer.law")


def no_other_file(path: str) -> SourceFile:
    raise FileNotFoundError(path)


@pytest.fixture(scope="module")
def cascade() -> Network:
    return cspdiag.load(MODELS / "cascade" / "cascade.csp").network


def in_c(network: Network, level: int) -> Run:
    return native.simulate(network, no_other_file, level=level, until=20_000_000, measured=True)


def test_laws_are_timed_in_python(cascade: Network) -> None:
    files = pipeline.generate(cascade, no_other_file)
    run = simulate(cascade, files, until=20_000_000, measured=True)
    assert {path: (time.what, time.steps) for path, time in run.execution_times.items()} == {
        "Cascade.inner.law": ("law", 200),
        "Cascade.outer.law": ("law", 20),
    }
    assert all(time.longest > 0 for time in run.execution_times.values())


def test_nothing_is_timed_unless_requested(cascade: Network) -> None:
    run = simulate(cascade, pipeline.generate(cascade, no_other_file), until=20_000_000)
    assert run.execution_times == {}


@needs_compiler
@pytest.mark.parametrize(("level", "what"), [(0, "process"), (1, "thread")])
def test_steps_are_timed_in_c(cascade: Network, level: int, what: str) -> None:
    times = in_c(cascade, level).execution_times
    assert {"Cascade.inner", "Cascade.outer"} <= set(times)
    assert {time.what for time in times.values()} == {what}
    assert times["Cascade.inner"].steps >= 200
    assert all(time.longest > 0 for time in times.values())
    laws = times_of_laws(cascade, [Measured(path, time.longest, time.what) for path, time in times.items()])
    assert set(laws) == set(LAWS)


@needs_compiler
def test_a_trace_keeps_them_for_the_timing_analysis(cascade: Network, tmp_path: Path) -> None:
    run = in_c(cascade, 1)
    path = tmp_path / "trace.json"
    run.to_trace(path)
    assert json.loads(path.read_text())["traceEvents"]
    found = {entry.path: entry for entry in measured_times(str(path)).steps}
    assert {name: entry.longest for name, entry in found.items()} == {
        name: time.longest for name, time in run.execution_times.items()
    }


def test_a_law_takes_no_longer_than_the_step_that_ran_it(cascade: Network) -> None:
    def given(*measured: Measured) -> dict[str, int]:
        return times_of_laws(cascade, measured)

    assert given(Measured("Cascade.inner", 7, "process")) == {"Cascade.inner.law": 7}
    assert given(Measured("Cascade.inner", 7, "process"), Measured("Cascade.inner.law", 5, "law")) == {
        "Cascade.inner.law": 5
    }
    assert given(Measured("Cascade", 9, "thread")) == dict.fromkeys(LAWS, 9)
    # The outermost process does not run the laws itself.
    assert given(Measured("Cascade", 9, "process")) == {}
