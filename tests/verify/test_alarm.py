"""The alarm ends what does not check the clock, and leaves nothing behind."""

from __future__ import annotations

import gc
import importlib
import subprocess
import sys
import threading
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest

from cspdiag import parse
from cspdiag.base import SourceFile
from cspdiag.obligations import proof_obligations
from cspdiag.proofs.answers.answer import Answer
from cspdiag.proofs.verdict import LimitError, Limits
from cspdiag.runtime.kernel.stopping import stopping
from cspdiag.verify import alarm
from cspdiag.verify.alarm import ended_by_alarm
from cspdiag.verify.confirm import Verifier
from tests.verify.test_time_limit import STUCK, read

pytestmark = pytest.mark.skipif(sys.implementation.name != "cpython", reason="needs exceptions in other threads")

BUSY = """process Busy {
  communication { var n : int = 0 }
  composition { mu (if n < 3 then skip else wait 1 ms) }
}
assert Busy livelock free
"""


def never_look_at_the_clock(*_: object) -> None:
    while True:
        pass


def test_what_does_not_look_at_the_clock_ends() -> None:
    with pytest.raises(LimitError, match=r"time limit of 0 s"), ended_by_alarm(Limits(seconds=0.0)):
        never_look_at_the_clock()


def test_the_alarm_rings_again_if_it_is_ignored() -> None:
    rung = 0
    with ended_by_alarm(Limits(seconds=0.0)):
        while rung < 2:
            try:
                never_look_at_the_clock()
            except LimitError:
                rung += 1


def test_an_alarm_is_not_mistaken_for_a_failure() -> None:
    def careless() -> None:
        try:
            never_look_at_the_clock()
        except Exception:
            pytest.fail("it was caught")

    with pytest.raises(LimitError), ended_by_alarm(Limits(seconds=0.0)):
        careless()


def test_a_limit_wrapped_in_another_exception_counts_as_the_limit() -> None:
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


@pytest.fixture
def often_switched() -> Iterator[None]:
    """Threads switch every tenth of a millisecond."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-4)
    yield
    sys.setswitchinterval(before)


@pytest.mark.usefixtures("often_switched")
@pytest.mark.filterwarnings("error")
def test_whenever_the_alarm_rings_the_answer_is_none_or_correct(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    obligations = proof_obligations(SourceFile(name="case.csp", text=STUCK), read)
    (question,) = obligations.questions
    whole = Verifier(obligations, read).answer(question, Limits())
    assert whole.outcome == "refuted"
    took = Verifier(obligations, read).answer(question, Limits()).seconds
    outcomes = set()
    for k in range(12):
        monkeypatch.setattr(alarm, "LATER", k * took / 10)
        verifier = Verifier(obligations, read, enforced=lambda _: ended_by_alarm(Limits(seconds=0.0)))
        answer = verifier.answer(question, Limits())
        assert answer.outcome == "refuted" or "the time limit of 0 s was reached" in answer.reason
        outcomes.add(answer.outcome)
    gc.collect()
    assert "unknown" in outcomes
    assert Verifier(obligations, read).answer(question, Limits()).counterexample == whole.counterexample
    assert capsys.readouterr().err == ""


def test_afterwards_no_alarm_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(alarm, "LATER", 0.01)
    hook, filters = sys.unraisablehook, list(warnings.filters)
    with ended_by_alarm(Limits()):
        (waiting,) = (thread for thread in threading.enumerate() if thread.name == "time limit")
    assert not waiting.is_alive()
    with pytest.raises(LimitError), ended_by_alarm(Limits(seconds=0.0)):
        never_look_at_the_clock()
    end = time.monotonic() + 0.05
    while time.monotonic() < end:
        pass
    assert (sys.unraisablehook, list(warnings.filters)) == (hook, filters)


@pytest.mark.parametrize("rings", [False, True])
def test_a_program_can_be_traced_afterwards(rings: bool) -> None:
    """Debuggers and coverage measurements trace; a hang of the interpreter itself is only visible from outside."""
    script = f"""
import sys
from cspdiag.proofs.verdict import LimitError, Limits
from cspdiag.verify.alarm import ended_by_alarm

def traced(frame, event, argument):
    return traced

try:
    with ended_by_alarm(Limits(seconds=0.0 if {rings} else 10.0)):
        while {rings}:
            pass
except LimitError:
    print("rung")
sys.settrace(traced)
(lambda: None)()
sys.settrace(None)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout == ("rung\n" if rings else "")


def test_the_alarm_rings_in_the_thread_that_requested_it() -> None:
    found: list[Answer] = []
    program = parse(BUSY)
    asking = threading.Thread(target=lambda: found.extend(program.verify(time_limit=0.5)), daemon=True)
    asking.start()
    asking.join(30)
    assert [answer.outcome for answer in found] == ["unknown"]
