"""Runs that are native where that is possible, and say what they were."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from cspdiag import load
from tests.cli.conftest import Command

needs_compiler = pytest.mark.skipif(
    not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler: install gcc or clang"
)
WATCHDOG = str(Path(__file__).parents[4] / "models/watchdog/watchdog.csp")


@pytest.fixture
def with_a_body(tmp_path: Path) -> str:
    (tmp_path / "body.py").write_text(
        "from cspdiag.runtime import Process\n\n\nclass P(Process):\n    async def run(self) -> None:\n        pass\n"
    )
    program = tmp_path / "top.csp"
    program.write_text('process P python "body.py:P" {}\nprocess Top { communication { p : P } composition { p } }\n')
    return str(program)


@needs_compiler
def test_a_program_runs_natively_with_the_same_results() -> None:
    program = load(WATCHDOG)
    chosen, python = (program.run(until=3, target=target) for target in ("auto", "python"))
    assert chosen.chosen_target == "as a native program"
    assert python.chosen_target == ""
    assert len(python.communications) > 10
    assert [c[:3] for c in chosen.communications] == [c[:3] for c in python.communications]
    assert chosen.outcome.time == python.outcome.time


@needs_compiler
def test_the_command_says_so_and_records_the_same(cspdiag: Command, tmp_path: Path) -> None:
    tables = [tmp_path / f"{target}.csv" for target in ("auto", "python")]
    for table in tables:
        result = cspdiag("run", WATCHDOG, "--for", "3s", "--target", table.stem, "--record", str(table))
        assert result.code == 0
        assert (", as a native program\n" in result.err) == (table.stem == "auto")
    assert tables[0].read_bytes() == tables[1].read_bytes()


def test_without_a_compiler_it_runs_in_python(cspdiag: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    result = cspdiag("run", WATCHDOG, "--for", "1s", "--target", "auto")
    assert result.code == 0
    assert ", in Python: CC is no-such-compiler, and there is no such command\n" in result.err


@needs_compiler
def test_what_is_written_in_python_runs_there(cspdiag: Command, with_a_body: str) -> None:
    result = cspdiag("run", with_a_body, "--target", "auto")
    assert result.code == 0
    assert ", in Python: " in result.err
    assert ": the body of the process `P` is a Python class (body.py:P), which C cannot call\n" in result.err
    assert "the body of the process `P` is a Python class" in load(with_a_body).run(target="auto").chosen_target


@needs_compiler
def test_a_plot_is_that_of_python(cspdiag: Command, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    plots = [tmp_path / f"{target}.svg" for target in ("auto", "python")]
    for plot in plots:
        result = cspdiag("run", WATCHDOG, "--for", "1s", "--target", plot.stem, "--plot", str(plot))
        assert result.code == 0
        assert (", in Python: a plot shows the variables inside processes\n" in result.err) == (plot.stem == "auto")
    assert plots[0].stat().st_size == plots[1].stat().st_size
