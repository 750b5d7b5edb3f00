"""``cspdiag bench``: wrong options are refused as those of the other verbs are, and failures are reported."""

from __future__ import annotations

import importlib
from argparse import Namespace
from pathlib import Path
from typing import Any

import pytest

from cspdiag.base.files.resources import benchmark_folder
from tests.cli.conftest import Command


@pytest.mark.parametrize("rounds", ["0", "-2", "abc", "1.5", "nan", ""])
def test_a_benchmark_runs_at_least_once(cspdiag: Command, rounds: str) -> None:
    assert cspdiag("bench", "--only", "memory", f"--rounds={rounds}") == (
        2,
        "",
        f"cspdiag: argument --rounds: expected a positive number, not {rounds!r} (try cspdiag bench --help)\n",
    )


@pytest.mark.parametrize(
    ("name", "help_"), [("memroy", "did you mean memory?"), ("nope", "there are: commstime, alternative-10, ")]
)
def test_an_unknown_benchmark_is_refused_on_one_line(cspdiag: Command, name: str, help_: str) -> None:
    result = cspdiag("bench", "--only", name)
    assert (result.code, result.out) == (2, "")
    assert result.err.startswith(f"cspdiag: argument --only: there is no benchmark '{name}': {help_}")
    assert result.err.endswith(" (try cspdiag bench --help)\n")
    assert result.err.count("\n") == 1


def test_the_help_names_the_benchmarks(cspdiag: Command) -> None:
    assert "commstime" in cspdiag("bench", "--help").out


@pytest.fixture
def measuring(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(benchmark_folder()))
    return importlib.import_module("measuring")


def test_a_program_that_fails_is_not_reported_as_missing(
    measuring: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "fine.py").write_text("print(12.5)")
    (tmp_path / "missing.py").write_text("")
    (tmp_path / "broken.py").write_text("print(1)\nraise TypeError('wrong call')")
    monkeypatch.setattr(measuring, "PROGRAMS", tmp_path)
    contestants = {"C": "fine", "peer": "missing", "other": "broken"}
    benchmark = measuring.Benchmark("some", "an operation", "ns", contestants)
    monkeypatch.setattr(measuring, "BENCHMARKS", (benchmark,))
    assert measuring.run(Namespace(only=["some"], rounds=2, json=None)) == 1
    captured = capsys.readouterr()
    assert captured.err == "  broken some: TypeError: wrong call\n"
    assert sorted(captured.out.splitlines()) == [
        "  C                  12.5 ns",
        "  other            failed",
        "  peer           not here",
        "some: an operation",
    ]


@pytest.mark.parametrize("name", ["check-30", "compile-30"])
def test_models_of_any_size_are_checked_and_compiled(measuring: Any, name: str) -> None:
    figures = measuring.run_program("checking", name)
    assert len(figures) == 3
    assert min(figures) > 0
