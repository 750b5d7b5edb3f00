"""The alarm ends what does not look at the clock, and leaves nothing behind."""

from __future__ import annotations

import signal
import threading
from pathlib import Path

import pytest

from cspdiag.analyses.proofs import portfolio
from cspdiag.analyses.proofs.verdict import LimitError, Limits
from cspdiag.cli.alarm import ended_by_alarm
from tests.cli.conftest import Command

pytestmark = pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs timers with signals")


def never_look_at_the_clock(*_: object) -> None:
    while True:
        pass


def test_what_does_not_look_at_the_clock_ends() -> None:
    with pytest.raises(LimitError, match=r"time limit of 0 s"), ended_by_alarm(Limits(seconds=0.0)):
        never_look_at_the_clock()


def test_the_alarm_rings_again_for_those_who_go_on() -> None:
    rung = 0
    with ended_by_alarm(Limits(seconds=0.0)):
        while rung < 2:
            try:
                never_look_at_the_clock()
            except LimitError:
                rung += 1


def test_afterwards_no_alarm_is_left() -> None:
    before = signal.getsignal(signal.SIGALRM)
    with ended_by_alarm(Limits()):
        assert signal.getitimer(signal.ITIMER_REAL)[0] > 0
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
    assert signal.getsignal(signal.SIGALRM) is before


def test_in_another_thread_there_is_none() -> None:
    seen: list[tuple[float, float]] = []

    def look() -> None:
        with ended_by_alarm(Limits()):
            seen.append(signal.getitimer(signal.ITIMER_REAL))

    thread = threading.Thread(target=look)
    thread.start()
    thread.join()
    assert seen == [(0.0, 0.0)]


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
