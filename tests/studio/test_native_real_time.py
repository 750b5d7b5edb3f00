"""Sessions of native programs in real time: with drivers in C, hands and sliders, and safe outputs however they end."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from tests.simulate.native.test_native import needs_compiler
from tests.studio.talking import Talk, program
from tests.studio.test_native import CRASH, LAW_C, LAW_H, VALVE, VALVE_C, VALVE_H
from tests.studio.test_real_time import PROGRAM, run_until
from tests.studio.test_session import KNOB

MS = 1_000_000
TUNED = VALVE.replace("process Scale", "parameter gain = 2.0\nprocess Scale").replace("2 * x", "gain * x")
TUNED = TUNED.replace("environment Bench for Scale {", "environment Bench for Scale on miss count {")
STARTS = '#include "law.h"\nvoid law_initialize(struct law *self) { (void)self; }\n'
SLOW_C = f"""#define _POSIX_C_SOURCE 199309L\n#include <time.h>\n{STARTS}
void law_calculate(struct law *self)
{{
    const struct timespec some = {{0, 25000000}};
    (void)self;
    (void)nanosleep(&some, NULL);
}}
"""
ENDLESS_C = f"""{STARTS}
void law_calculate(struct law *self) {{ while (self->knob > 0.5) {{ }} }}
"""
HANGING_C = VALVE_C.replace("    FILE *const", "    while (self->valve > 1.5) { }\n    FILE *const")

pytestmark = needs_compiler


class Valve:
    """A program whose driver in C writes to a file."""

    def __init__(self, folder: Path, text: str = TUNED, source: str = VALVE_C) -> None:
        self._written = folder / "values"
        self.text = text
        self.files = {"valve.csp": text, "valve.h": VALVE_H, "valve.c": source.replace("PLACE", str(self._written))}
        for name, content in self.files.items():
            (folder / name).write_text(content)
        self.start = {"files": self.files, "main": "valve.csp", "target": "c", "real_time": True}

    @property
    def values(self) -> list[str]:
        """What it was given until now."""
        return self._written.read_text().split() if self._written.exists() else []

    def expect(self, value: str) -> None:
        """Wait until it was given this value."""
        wait_until(lambda: value in self.values)

    def expect_safe(self) -> None:
        """Wait until it was given the safe value, as the last one."""
        wait_until(lambda: self.values[-1:] == ["-1"])
        time.sleep(0.05)
        assert self.values[-1] == "-1"


def wait_until(happened: Callable[[], bool]) -> None:
    over = time.monotonic() + 60
    while not happened():
        assert time.monotonic() < over
        time.sleep(0.02)


@pytest.fixture
def valve(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Valve:
    monkeypatch.chdir(tmp_path)
    return Valve(tmp_path)


def frames_of(talk: Talk) -> list[dict[str, Any]]:
    return [each["params"] for each in talk.notifications if each["method"] == "frame"]


def test_it_keeps_pace_with_its_driver_and_takes_hands_and_sliders(talk: Talk, valve: Valve) -> None:
    started = talk.ask("start", **valve.start)
    assert (started["real_time"], started["target"]) == (True, "c")
    assert {signal["name"]: signal["hand"] for signal in started["signals"]} == {"knob": True, "valve": False}
    assert talk.ask("play", session=1, speed=1) == {}
    valve.expect("2")
    run_until(talk, 150 * MS)
    began, at = time.monotonic(), talk.ask("state", session=1)["now"]
    deeds: list[tuple[str, dict[str, Any]]] = [
        ("input", {"name": "knob", "value": 5}),
        ("tune", {"name": "gain", "value": 3}),
        ("input", {"name": "knob", "value": None}),
    ]
    for count, (method, params) in enumerate(deeds, 1):
        talk.ask(method, session=1, **params)
        run_until(talk, at + count * 200 * MS)
    passed = talk.ask("state", session=1)["now"] - at
    assert passed / 1e9 == pytest.approx(time.monotonic() - began, abs=0.2)
    for value in ("2", "10", "15", "3"):
        valve.expect(value)
    assert talk.ask("state", session=1)["waiting"][0]["process"] == "Scale"
    talk.ask("stop", session=1)
    valve.expect_safe()
    frames = frames_of(talk)
    assert [frame["to"] for frame in frames[:-1]] == [frame["from"] for frame in frames[1:]]
    assert all(frame["from"] <= frame["to"] for frame in frames)
    assert frames[-1]["signals"]["valve"]["v"][-1] == -1
    assert [change["value"] for frame in frames for change in frame["changes"]] == [3]
    times = [time for frame in frames for time in frame["signals"].get("knob", {"t": []})["t"]]
    assert times[:3] == [10 * MS, 20 * MS, 30 * MS]
    ended = talk.notifications[-1]["params"]
    assert (ended["reason"], ended["at"]) == ("stopped", frames[-1]["to"])
    assert " instants, late by " in ended["text"]


def test_where_time_does_not_decide_the_page_sees_what_it_sees_of_python(talk: Talk) -> None:
    seen, slow = [], KNOB.replace("10 ms", "250 ms")
    for number, target in enumerate(("python", "c"), 1):
        # At the time limit itself it depends on the time what still runs.
        talk.ask("start", **program(slow), target=target, real_time=True, until="1100 ms")
        while talk.engine.keeps_pace:
            talk.engine.proceed()
        signals: dict[str, list[Any]] = {}
        communications = []
        for frame in (frame for frame in frames_of(talk) if frame["session"] == number):
            communications += frame["communications"]
            for name, values in frame["signals"].items():
                signals.setdefault(name, []).extend(zip(values["t"], values["v"], strict=True))
        ended = talk.notifications[-1]["params"]
        seen.append((signals, communications, ended["reason"], ended["at"], ended["missed"]))
    assert seen[1] == seen[0]
    assert seen[0][2:4] == ("until", 1100 * MS)


def test_what_only_virtual_time_has_is_refused(talk: Talk) -> None:
    talk.ask("start", **program(KNOB), target="c", real_time=True)
    assert "not paused" in talk.refused("pause", session=1)
    assert "not paused" in talk.refused("step", session=1)
    assert "speed 1" in talk.refused("play", session=1, speed=2)
    talk.ask("stop", session=1)
    assert "has ended" in talk.refused("play", session=1, speed=1)


def test_missed_samples_are_shown(talk: Talk) -> None:
    text = CRASH.replace("environment Bench for Crash {", "environment Bench for Crash on miss count {")
    files = {"p.csp": text, "law.c": SLOW_C, "law.h": LAW_H}
    talk.ask("start", files=files, main="p.csp", target="c", real_time=True)
    frames = run_until(talk, 400 * MS)
    assert frames[-1]["missed"]["knob"] > 3
    talk.ask("stop", session=1)
    assert talk.notifications[-1]["params"]["missed"]["knob"] >= frames[-1]["missed"]["knob"]


def test_a_crash_ends_it_in_words(talk: Talk) -> None:
    files = {"p.csp": CRASH, "law.c": LAW_C, "law.h": LAW_H}
    talk.ask("start", files=files, main="p.csp", target="c", real_time=True)
    while talk.engine.keeps_pace:
        talk.engine.proceed()
    ended = talk.notifications[-1]["params"]
    assert ended["reason"] == "fault"
    assert "Error" not in ended["text"]
    assert "the native program has failed: it was ended by SIGABRT, a crash" in ended["text"]
    assert "a crash in Crash.law (" in ended["text"]


@pytest.mark.parametrize("real_time", [True, False])
def test_a_computation_without_end_is_stopped_soon_and_outputs_are_safe(
    talk: Talk, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, real_time: bool
) -> None:
    monkeypatch.chdir(tmp_path)
    text = TUNED.replace("var x : double = 0", "var x : double = 0  law : Law  x -> law.knob")
    text = text.replace("knob ? x ;", "knob ? x ; law ;")
    valve = Valve(tmp_path, f'{text}submodel Law c "law.c" {{ in knob : double }}\n')
    files = {**valve.files, "law.c": ENDLESS_C, "law.h": LAW_H}
    talk.ask("start", **{**valve.start, "real_time": real_time, "files": files})
    talk.ask("play", session=1, speed=1)
    over = time.monotonic() + 0.6
    while time.monotonic() < over:
        before = time.monotonic()
        talk.engine.proceed()
        assert time.monotonic() - before < 0.5, "requests wait meanwhile"
    assert talk.ask("state", session=1)["now"] <= 20 * MS
    began = time.monotonic()
    talk.ask("stop", session=1)
    assert time.monotonic() - began < 2.2
    assert valve.values == ["-1"]
    ended = talk.notifications[-1]["params"]
    assert ended["reason"] == "stopped"
    who = "Scale (last waited at valve.csp:7)"
    why = f"{who} did not end and was interrupted; the outputs have their safe values"
    assert ended["text"].splitlines()[1] == why


def test_it_is_said_that_a_device_which_hangs_may_be_as_it_was(
    talk: Talk, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    valve = Valve(tmp_path, source=HANGING_C.replace("self->valve > 1.5", "self != 0"))
    talk.ask("start", **{**valve.start, "real_time": False})
    talk.ask("play", session=1, speed=1)
    over = time.monotonic() + 0.3
    while time.monotonic() < over:
        talk.engine.proceed()
    began = time.monotonic()
    talk.ask("stop", session=1)
    assert time.monotonic() - began < 2.5
    text = talk.notifications[-1]["params"]["text"]
    assert "was killed, and outputs may be as they were" in text
    assert "Error" not in text


class EngineInProcess:
    """An engine that runs the program of a valve."""

    def __init__(self, valve: Valve, folder: Path) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "cspdiag.studio.engine", str(folder / "valve.csp")],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps({"id": 1, "method": "start", "params": valve.start}) + "\n")
        self.process.stdin.flush()
        assert self.process.stdout is not None
        assert "result" in json.loads(self.process.stdout.readline())
        valve.expect("2")

    @property
    def native(self) -> int:
        """The native program."""
        (child,) = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        return int(child)


@pytest.fixture
def engine(valve: Valve, tmp_path: Path) -> Iterator[EngineInProcess]:
    found = EngineInProcess(valve, tmp_path)
    process = found.process
    assert process.stdin is not None
    assert process.stdout is not None
    yield found
    with suppress(ProcessLookupError, BrokenPipeError):
        process.kill()
        process.stdin.close()
    process.stdout.close()
    process.wait()


@pytest.mark.parametrize("ending", ["end of input", "SIGTERM", "SIGINT", "SIGKILL", "nobody reads", "reader gone"])
def test_outputs_are_released_when_nobody_is_there_any_more(valve: Valve, engine: EngineInProcess, ending: str) -> None:
    process, native = engine.process, engine.native
    assert process.stdin is not None
    assert process.stdout is not None
    if ending == "end of input":
        process.stdin.close()
    elif ending.startswith("SIG"):
        process.send_signal(signal.Signals[ending])
    elif ending == "reader gone":
        process.stdout.close()
    if ending in ("end of input", "SIGTERM", "SIGINT"):
        assert json.loads(list(process.stdout)[-1])["params"]["reason"] == "stopped"
    process.wait(20)
    valve.expect_safe()
    wait_until(lambda: not is_alive(native))


def test_a_program_that_was_stopped_by_a_signal_is_not_left_behind(engine: EngineInProcess) -> None:
    native = engine.native
    os.kill(native, signal.SIGSTOP)
    assert engine.process.stdin is not None
    assert engine.process.stdout is not None
    began = time.monotonic()
    engine.process.stdin.close()
    ended = json.loads(list(engine.process.stdout)[-1])["params"]
    engine.process.wait(20)
    assert time.monotonic() - began < 6  # The server kills an engine that takes longer.
    assert not is_alive(native)
    assert "was killed, and outputs may be as they were" in ended["text"]


@pytest.mark.skipif(sys.platform != "linux", reason="the system has to say that the engine has died")
def test_a_program_that_was_stopped_continues_to_its_release_when_its_engine_is_killed(
    valve: Valve, engine: EngineInProcess
) -> None:
    native = engine.native
    os.kill(native, signal.SIGSTOP)
    engine.process.kill()
    engine.process.wait(20)
    valve.expect_safe()
    wait_until(lambda: not is_alive(native))


def is_alive(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(") ")[2][0] not in "ZX"
    except OSError:
        return False


def test_drivers_are_refused_in_words_of_the_page(talk: Talk, valve: Valve) -> None:
    peer = PROGRAM.replace("PORT", "9999")
    answer = talk.answer("start", **program(peer), target="c", real_time=True)["error"]
    why = 'the driver `Peer` is the device "udp", a Python class, which a native program cannot call'
    assert why in answer["message"]
    assert "--" not in answer["message"]
    assert answer["help"] == "run it as Python, or choose another environment"
    answer = talk.answer("start", **{**valve.start, "target": "python"})["error"]
    assert "the driver `Valve` is written in C, which Python cannot call" in answer["message"]
    assert "--" not in answer["message"]
    assert answer["help"] == "run it as C, or choose another environment"
