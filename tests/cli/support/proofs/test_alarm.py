"""The alarm ends what does not look at the clock, and leaves nothing behind."""

from __future__ import annotations

import gc
import importlib
import signal
import sys
import threading
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.cli.support.proofs import alarm
from cspdiag.cli.support.proofs.alarm import ended_by_alarm
from cspdiag.proofs import portfolio
from cspdiag.proofs.verdict import LimitError, Limits
from cspdiag.runtime.kernel.stopping import stopping
from cspdiag.verify.confirm import Verifier
from tests.cli.conftest import Command
from tests.verify.test_time_limit import STUCK, read

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


def test_nobody_takes_it_for_a_failure_of_what_was_called() -> None:
    def careless() -> None:
        try:
            never_look_at_the_clock()
        except Exception:
            pytest.fail("it was caught")

    with pytest.raises(LimitError), ended_by_alarm(Limits(seconds=0.0)):
        careless()


def test_what_others_make_of_it_counts_as_the_limit() -> None:
    def rewriting() -> None:
        try:
            never_look_at_the_clock()
        except BaseException as problem:
            raise ValueError("a mistake in a template") from problem

    with pytest.raises(LimitError, match=r"time limit of 0 s"), ended_by_alarm(Limits(seconds=0.0)):
        rewriting()


def test_what_fails_before_it_rings_is_a_failure() -> None:
    with pytest.raises(ValueError, match="a mistake"), ended_by_alarm(Limits()):
        raise ValueError("a mistake")


def test_a_process_of_the_program_does_not_catch_it() -> None:
    ended = []

    def running() -> None:
        try:
            never_look_at_the_clock()
        except BaseException as error:
            ended.append(stopping.ends_run(error))
            raise

    with pytest.raises(LimitError), ended_by_alarm(Limits(seconds=0.0)):
        running()
    assert ended == [True]


def test_modules_are_loaded_to_their_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "slow_to_load.py").write_text(
        "import time\nend = time.monotonic() + 0.1\nwhile time.monotonic() < end: pass\nloaded = True\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(alarm, "LATER", 0.02)

    def loading() -> None:
        importlib.import_module("slow_to_load")
        never_look_at_the_clock()

    with pytest.raises(LimitError), ended_by_alarm(Limits(seconds=0.0)):
        loading()
    assert sys.modules.pop("slow_to_load").loaded


@pytest.mark.filterwarnings("error")
def test_at_whatever_moment_it_rings_the_answer_is_none_or_the_right_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    obligations = pipeline.proof_obligations(SourceFile(name="case.csp", text=STUCK), read)
    (question,) = obligations.questions
    whole = Verifier(obligations, read).answer(question, Limits())
    assert whole.outcome == "refuted"
    took = Verifier(obligations, read).answer(question, Limits()).seconds
    outcomes = set()
    for k in range(25):
        monkeypatch.setattr(alarm, "LATER", (k + 1) * took / 20)
        verifier = Verifier(obligations, read, enforced=lambda _: ended_by_alarm(Limits(seconds=0.0)))
        answer = verifier.answer(question, Limits())
        assert answer.outcome == "refuted" or "the time limit of 0 s was reached" in answer.reason
        outcomes.add(answer.outcome)
    gc.collect()
    assert "unknown" in outcomes
    assert Verifier(obligations, read).answer(question, Limits()).counterexample == whole.counterexample
    assert capsys.readouterr().err == ""


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
