"""Where a program no longer follows a trace: the sentence has the names, channels and places of the counterexample."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.conftest import Command, cspdiag  # noqa: F401 - a fixture

BRANCHES = """process Top(n : int = 2) {
  in p : int
  communication {
    channel b : int any
    channel q : int buffer 1
    var w : int = 0
    var y : int = 0
    var z : int = 0
  }
  composition {
    ( ((seq k < n : q ! k) ; b ! 3 ; q ! 9)
    || (b ? y)
    || (q ? z ; stop) )
  }
}
assert Top deadlock free
"""
"""Three branches without names; nothing is left open in a proof about it."""


@pytest.fixture
def trace(cspdiag: Command, tmp_path: Path) -> tuple[Path, Path]:  # noqa: F811
    program, trace = tmp_path / "d.csp", tmp_path / "d.json"
    program.write_text(BRANCHES)
    assert cspdiag("verify", program, "--trace-out", trace).code == 1
    return program, trace


def test_names_channels_and_places_are_those_of_the_counterexample(
    cspdiag: Command,  # noqa: F811
    trace: tuple[Path, Path],
) -> None:
    result = cspdiag("run", trace[0], "--replay", trace[1], "--set", "n=0")
    assert result.code == 1
    assert "`q 0` does not happen: `1` waits to write b (d.csp:11)\n" in result.err
    assert "Top.b" not in result.err


@pytest.mark.parametrize(
    ("written", "where"),
    [
        ("wait 7 ms", "`1` is in `wait 7 ms` (d.csp:11)"),
        ("(p ? w -> skip [] after 5 ms -> skip)", "`1` waits to read p or after 5 ms (d.csp:11)"),
        ("(if n > 1 then stop)", "`1` waits forever, at stop (d.csp:11)"),
    ],
)
def test_what_a_process_does_instead_is_put_as_in_reports_of_deadlocks(
    cspdiag: Command,  # noqa: F811
    trace: tuple[Path, Path],
    written: str,
    where: str,
) -> None:
    program, recorded = trace
    program.write_text(BRANCHES.replace("(seq k < n : q ! k)", written))
    result = cspdiag("run", program, "--replay", recorded)
    assert f": {where}\n" in result.err


def test_settings_that_differ_from_those_of_the_trace_are_named(
    cspdiag: Command,  # noqa: F811
    trace: tuple[Path, Path],
) -> None:
    program, recorded = trace
    other = cspdiag("run", program, "--replay", recorded, "--set", "n=0")
    assert other.err.endswith("\n  n is set to 0; the trace was made without this setting\n")
    assert "is set to" not in cspdiag("run", program, "--replay", recorded, "--set", "n=2").err
    cspdiag("verify", program, "--trace-out", recorded, "--set", "n=4")
    other = cspdiag("run", program, "--replay", recorded, "--set", "n=0")
    assert other.err.endswith("\n  n is set to 0; the trace was made with n=4\n")
    assert "is set to" not in cspdiag("run", program, "--replay", recorded).err
