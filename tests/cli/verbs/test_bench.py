"""``cspdiag bench``: wrong options are refused as those of the other verbs are."""

from __future__ import annotations

import pytest

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
