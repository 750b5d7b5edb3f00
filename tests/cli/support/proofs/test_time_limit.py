"""A proof that reaches its time limit is an answer of the command line, too."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag.proofs import portfolio
from tests.cli.conftest import Command
from tests.verify.test_alarm import never_look_at_the_clock


def test_a_method_that_never_looks_at_the_clock_is_an_unknown_answer(
    cspdiag: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(portfolio._ENGINES, "rules", never_look_at_the_clock)
    program = tmp_path / "idle.csp"
    program.write_text("process Idle {\n  composition {\n    mu wait 1 s\n  }\n}\n\nassert Idle deadlock free\n")
    result = cspdiag("verify", "--no-cache", "--time-limit", "0.01", str(program))
    assert result.code == 1
    assert "UNKNOWN  Idle deadlock free" in result.err
    assert "the time limit of 0.01 s was reached" in result.err
