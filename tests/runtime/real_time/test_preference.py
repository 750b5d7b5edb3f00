"""What a run against the clock asks of the operating system and of the interpreter, and that it gives it back."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from cspdiag.runtime import Network, Outcome, ms, wait
from cspdiag.runtime.real_time import preference
from tests.runtime.support import Body

pytestmark = pytest.mark.skipif(not hasattr(os, "sched_setscheduler"), reason="this system has no scheduling classes")

Settings = tuple[int, float, int, str]


def settings() -> Settings:
    status = Path("/proc/self/status").read_text()
    locked = next(line for line in status.splitlines() if line.startswith("VmLck"))
    return os.sched_getscheduler(threading.get_native_id()), sys.getswitchinterval(), gc.get_freeze_count(), locked


def ran(body: Callable[[], object], *, real_time: bool = True) -> Outcome:
    async def top() -> None:
        body()
        await wait(1 * ms)

    return Network(Body(top)).run(real_time=real_time)


@pytest.fixture(autouse=True)
def nothing_frozen() -> Iterator[None]:
    """A run leaves objects frozen that were so before; those of the tests are."""
    gc.unfreeze()
    yield
    gc.freeze()


def permitted() -> bool:
    before = os.sched_getscheduler(0)
    try:
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))
    except OSError:
        return False
    os.sched_setscheduler(0, before, os.sched_param(0))
    return True


@pytest.fixture
def worker() -> Iterator[threading.Thread]:
    ended = threading.Event()
    thread = threading.Thread(target=ended.wait)
    thread.start()
    yield thread
    ended.set()
    thread.join()


def test_what_a_run_is_granted_holds_while_it_lasts() -> None:
    before = settings()
    seen: list[Settings] = []
    outcome = ran(lambda: seen.append(settings()))
    (during,) = seen
    assert settings() == before
    assert during[1] == pytest.approx(0.0002)
    assert during[2] > before[2]
    assert (during[0] == os.SCHED_RR) == outcome.preference.startswith("SCHED_RR, ") == permitted()
    assert (during[3] != before[3]) == outcome.preference.endswith(", memory locked")


def test_a_run_that_fails_gives_it_back() -> None:
    def fails() -> None:
        raise ValueError("of the program")

    before = settings()
    assert ran(fails).ended == "failed"
    assert settings() == before


def test_virtual_time_asks_for_nothing() -> None:
    before = settings()
    seen: list[Settings] = []
    assert ran(lambda: seen.append(settings()), real_time=False).preference == ""
    assert seen == [before]


def test_what_is_not_permitted_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError

    calls: list[tuple[Any, ...]] = []
    refused: dict[str, Callable[..., int]] = {
        "mlockall": lambda *_: -1,
        "munlockall": lambda *_: 0,
        "prctl": lambda *given: calls.append(given) or 0,
    }
    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    monkeypatch.setattr(preference, "_function", refused.__getitem__)
    outcome = ran(lambda: None)
    assert outcome.ended == "terminated"
    assert outcome.preference == "ordinary scheduling: SCHED_RR is not permitted, memory not locked: not permitted"
    assert calls == [(29, 1, 0, 0, 0), (29, 0, 0, 0, 0)], "waits are precise while it lasts"


def test_a_system_without_any_of_it_runs_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(os, "sched_setscheduler")
    monkeypatch.setattr(preference, "_function", lambda _: None)
    monkeypatch.setattr(preference, "_status", dict)
    assert ran(lambda: None).preference == (
        "ordinary scheduling: this system has no SCHED_RR, memory not locked: this system cannot"
    )


@pytest.mark.skipif(not permitted(), reason="SCHED_RR is not permitted here")
def test_other_threads_come_right_after_it(worker: threading.Thread) -> None:
    assert worker.native_id is not None
    seen: list[tuple[int, int]] = []
    ended = threading.Event()
    started_by_it = threading.Thread(target=ended.wait)

    def body() -> None:
        started_by_it.start()
        for number in (0, worker.native_id or 0):
            seen.append((os.sched_getscheduler(number), os.sched_getparam(number).sched_priority))

    ran(body)
    (own_class, own_level), (other_class, other_level) = seen
    assert own_class == other_class == os.SCHED_RR
    assert other_level == own_level - 1
    assert os.sched_getscheduler(worker.native_id) == os.SCHED_OTHER
    assert started_by_it.native_id is not None
    assert os.sched_getscheduler(started_by_it.native_id) == os.SCHED_OTHER
    ended.set()
    started_by_it.join()


@pytest.mark.skipif(not permitted(), reason="SCHED_RR is not permitted here")
def test_a_class_that_was_chosen_outside_is_respected() -> None:
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(3))
    try:
        seen: list[int] = []
        outcome = ran(lambda: seen.append(os.sched_getscheduler(0)))
        assert seen == [os.SCHED_FIFO]
        assert outcome.preference.startswith("scheduled as it was started, ")
        assert (os.sched_getscheduler(0), os.sched_getparam(0).sched_priority) == (os.SCHED_FIFO, 3)
    finally:
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


def test_a_signal_while_it_is_asked_for_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    class AskedError(Exception):
        pass

    def request(*_: object) -> None:
        raise AskedError

    before = settings()
    monkeypatch.setattr(preference, "_status", lambda: signal.raise_signal(signal.SIGTERM) or {})
    handler = signal.signal(signal.SIGTERM, request)
    try:
        with pytest.raises(AskedError):
            ran(lambda: None)
    finally:
        signal.signal(signal.SIGTERM, handler)
    assert settings() == before


def test_runs_at_once_give_it_back_with_the_last_one() -> None:
    def body(limit: int) -> Body:
        async def top() -> None:
            await wait(limit)

        return Body(top)

    allowed = permitted()
    before = settings()
    outcomes: dict[int, Outcome] = {}

    def run(limit: int) -> None:
        outcomes[limit] = Network(body(limit)).run(real_time=True)

    threads = [threading.Thread(target=run, args=(limit * ms,)) for limit in (100, 300)]
    for thread in threads:
        thread.start()
    threads[0].join()
    assert sys.getswitchinterval() == pytest.approx(0.0002), "the other one still runs"
    assert threads[1].native_id is not None
    assert (os.sched_getscheduler(threads[1].native_id) == os.SCHED_RR) == allowed
    threads[1].join()
    after = settings()
    assert (after[0], after[1], after[3]) == (before[0], before[1], before[3])
    assert len({outcome.preference for outcome in outcomes.values()}) == 1


def test_what_the_program_froze_stays_frozen() -> None:
    gc.freeze()
    try:
        before = gc.get_freeze_count()
        ran(lambda: None)
        assert gc.get_freeze_count() > before // 2 > 0, "some of it has been freed"
    finally:
        gc.unfreeze()


HANGS = """
import os
from cspdiag.runtime import EventOutput, Network, Process, ms, wait

os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})

class Motor:
    def write(self, value):
        print(value, flush=True)

class Top(Process):
    def __init__(self):
        super().__init__("Top")

    async def run(self):
        await motor.write(3.0)
        await wait(1 * ms)
        while True:
            pass

motor = EventOutput("motor", driver=Motor(), safe=0.0)
outcome = Network(Top(), [motor]).run(real_time=True)
print(outcome.ended, outcome.error)
"""


def test_a_step_that_never_ends_is_ended_on_one_processor(tmp_path: Path) -> None:
    """The watch has to be able to preempt it."""
    program = tmp_path / "hangs.py"
    program.write_text(HANGS)
    done = subprocess.run([sys.executable, str(program)], capture_output=True, text=True, timeout=30, check=False)
    assert done.stdout.splitlines()[:2] == ["3.0", "0.0"]
    assert "has not finished its step within 2 s" in done.stdout
