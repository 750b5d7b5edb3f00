"""Sessions in real time, with a device: they keep pace, and their outputs are released however they end."""

from __future__ import annotations

import fcntl
import json
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from cspdiag.studio.engine.engine import Engine
from tests.studio.talking import Talk, program

PROGRAM = """\
driver Peer(port: int, to: text) device "udp" { in valve : double }
process Scale {
  in  knob  : double @ 10 ms
  out valve : double @ 10 ms safe -1
  communication { var x : double = 0 }
  composition { mu (knob ? x ; valve ! 2 * x) }
}
submodel Still { out knob : double  knob = 1.0 }
environment Bench for Scale on miss count {
  still : Still
  peer : Peer(port = 0, to = "127.0.0.1:PORT")
  still.knob -> knob
  valve -> peer.valve
}
"""
SLOW = """\
process Slow {
  in knob : double @ 1 ms
  communication { var x : double = 0  law : Law  knob -> law.knob }
  composition { mu law }
}
submodel Law python "law.py:Law" { in knob : double }
submodel Still { out knob : double  knob = 1.0 }
environment Bench for Slow on miss count { still : Still  still.knob -> knob }
"""
SAFE = -1.0


class Valve:
    """A device that takes values."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(0.05)
        self.text = PROGRAM.replace("PORT", str(self._socket.getsockname()[1]))
        self.values: list[float] = []
        self._is_there = True
        self._thread = threading.Thread(target=self._listen)
        self._thread.start()

    def _listen(self) -> None:
        while self._is_there:
            with suppress(TimeoutError):
                self.values.append(json.loads(self._socket.recv(1000))["valve"])

    def expect(self, wanted: float) -> None:
        """Wait until it was given this value."""
        over = time.monotonic() + 20
        while wanted not in self.values:
            assert time.monotonic() < over
            time.sleep(0.01)

    @property
    def is_safe(self) -> bool:
        """Whether the safe value is the last one that it was given."""
        self.expect(SAFE)
        return self.values[-1] == SAFE

    def close(self) -> None:
        """It is gone."""
        self._is_there = False
        self._thread.join()
        self._socket.close()


@pytest.fixture
def valve() -> Iterator[Valve]:
    found = Valve()
    yield found
    found.close()


def run_until(talk: Talk, until: int) -> list[dict[str, Any]]:
    """The frames until an instant."""
    while talk.engine.keeps_pace and talk.ask("state", session=1)["now"] < until:
        talk.engine.proceed()
    return [each["params"] for each in talk.notifications if each["method"] == "frame"]


def test_it_keeps_pace_with_the_clock_and_takes_a_hand(talk: Talk, valve: Valve) -> None:
    began = time.monotonic()
    started = talk.ask("start", **program(valve.text), real_time=True)
    assert started["real_time"]
    assert {signal["name"]: signal["hand"] for signal in started["signals"]} == {"knob": True, "valve": False}
    assert talk.ask("play", session=1, speed=1) == {}
    run_until(talk, 150_000_000)
    talk.ask("input", session=1, name="knob", value=5)
    frames = run_until(talk, 300_000_000)
    assert time.monotonic() - began >= 0.3
    assert [frame["to"] for frame in frames[:-1]] == [frame["from"] for frame in frames[1:]]
    assert [time for frame in frames for time in frame["signals"].get("knob", {"t": []})["t"]][:3] == [
        10_000_000, 20_000_000, 30_000_000,
    ]  # fmt: skip
    valve.expect(2)
    valve.expect(10)
    talk.ask("stop", session=1)
    assert valve.is_safe
    ended = talk.notifications[-1]["params"]
    assert ended["reason"] == "stopped"
    assert "jitter of the 10 ms period" in ended["text"]


def test_it_ends_at_its_time_limit(talk: Talk, valve: Valve) -> None:
    talk.ask("start", **program(valve.text), real_time=True, until="60 ms")
    run_until(talk, 1_000_000_000)
    ended = talk.notifications[-1]["params"]
    assert (ended["reason"], ended["at"]) == ("until", 60_000_000)
    assert valve.is_safe


def test_what_only_virtual_time_has_is_refused(talk: Talk, valve: Valve) -> None:
    talk.ask("start", **program(valve.text), real_time=True)
    assert "not paused" in talk.refused("pause", session=1)
    assert "not paused" in talk.refused("step", session=1)
    assert "speed 1" in talk.refused("play", session=1, speed=2)
    assert "true or false" in talk.refused("start", **program(valve.text), real_time=1)


def test_a_browser_has_no_real_time() -> None:
    engine = Engine(lambda method, params: None, kind="browser")
    assert not engine.request({"id": 1, "method": "hello"})["result"]["able"]["real_time"]
    answer = engine.request({"id": 1, "method": "start", "params": {**program(PROGRAM), "real_time": True}})
    assert "virtual time" in answer["error"]["message"]


def test_missed_samples_are_shown(talk: Talk) -> None:
    law = "import time\nclass Law:\n    def calculate(self, knob):\n        time.sleep(0.004)\n"
    talk.ask("start", files={"p.csp": SLOW, "law.py": law}, main="p.csp", real_time=True)
    frames = run_until(talk, 60_000_000)
    assert frames[-1]["missed"]["knob"] > 10
    talk.ask("stop", session=1)
    assert talk.notifications[-1]["params"]["missed"]["knob"] >= frames[-1]["missed"]["knob"]


def test_a_device_that_fails_ends_the_run(talk: Talk) -> None:
    text = PROGRAM.replace("port: int, to: text", "port: int, patience: time = 20 ms").replace("in valve", "out knob")
    text = text.replace(', to = "127.0.0.1:PORT"', "").replace(
        "still.knob -> knob\n  valve -> peer.valve", "peer.knob -> knob"
    )
    text = text.replace("  out valve : double @ 10 ms safe -1\n", "").replace("valve ! 2 * x", "skip")
    talk.ask("start", **program(text), real_time=True)
    talk.engine.proceed()
    ended = talk.notifications[-1]["params"]
    assert ended["reason"] == "fault"
    assert "udp 127.0.0.1:0 failed to open at port Scale.knob" in ended["text"]
    assert not talk.engine.keeps_pace


class EngineInProcess:
    """An engine that runs the program of the valve."""

    def __init__(self, valve: Valve, folder: Path) -> None:
        file = folder / "valve.csp"
        file.write_text(valve.text)
        self.process = subprocess.Popen(
            [sys.executable, "-m", "cspdiag.studio.engine", str(file)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        assert self.process.stdout is not None
        fcntl.fcntl(self.process.stdout, fcntl.F_SETPIPE_SZ, 4096)
        self._send("start", **program(valve.text), real_time=True)
        valve.expect(2)

    def _send(self, method: str, **params: Any) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps({"id": 1, "method": method, "params": params}) + "\n")
        self.process.stdin.flush()


@pytest.mark.parametrize("ending", ["end of input", "SIGTERM", "SIGINT", "nobody reads", "reader gone"])
def test_outputs_are_released_when_nobody_is_there_any_more(valve: Valve, tmp_path: Path, ending: str) -> None:
    engine = EngineInProcess(valve, tmp_path)
    process = engine.process
    assert process.stdin is not None
    assert process.stdout is not None
    if ending == "end of input":
        process.stdin.close()
    elif ending.startswith("SIG"):
        process.send_signal(signal.Signals[ending])
    elif ending == "reader gone":
        process.stdout.close()
    if ending in ("end of input", "SIGTERM", "SIGINT"):
        messages = [json.loads(line) for line in process.stdout]
        assert messages[-1]["params"]["reason"] == "stopped"
    process.wait(20)
    assert valve.is_safe
    process.stdin.close()
    process.stdout.close()
