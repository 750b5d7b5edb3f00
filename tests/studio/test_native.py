"""Sessions of native programs: what happens in them is what happens in Python, and their outputs are released however
they end.
"""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cspdiag import load, pipeline
from cspdiag.base.sources import read_source
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.runtime.kernel.parameters import Change
from cspdiag.simulate.native.run import build_program
from cspdiag.simulate.record.files import csv_parts, plain_trace_text
from cspdiag.simulate.record.run_data import RunData
from cspdiag.simulate.run.live import LiveRun
from cspdiag.simulate.steered.run import SteeredRun
from cspdiag.studio.engine.engine import Engine
from tests.simulate.native.test_native import needs_compiler
from tests.studio.talking import MODELS, Talk, program
from tests.studio.test_session import KNOB, LIVELOCK, Player

MS = 1_000_000
VALVE = """\
driver Valve() c "valve.c" { in valve : double }
process Scale {
  in  knob  : double @ 10 ms
  out valve : double @ 10 ms safe -1
  communication { var x : double = 0 }
  composition { mu (knob ? x ; valve ! 2 * x) }
}
submodel Still { out knob : double  knob = 1.0 }
environment Bench for Scale {
  still : Still
  device : Valve()
  still.knob -> knob
  valve -> device.valve
}
"""
VALVE_H = """\
#pragma once
#include <stdbool.h>
struct valve { double valve; };
bool valve_open(struct valve *self);
void valve_close(struct valve *self);
void valve_write_valve(struct valve *self);
"""
VALVE_C = """\
#include "valve.h"
#include <stdio.h>
bool valve_open(struct valve *self) { (void)self; return true; }
void valve_close(struct valve *self) { (void)self; }
void valve_write_valve(struct valve *self)
{
    FILE *const file = fopen("PLACE", "a");
    (void)fprintf(file, "%g\\n", self->valve);
    (void)fclose(file);
}
"""
CRASH = """\
process Crash {
  in  knob : double @ 10 ms
  communication { var x : double = 0  law : Law  knob -> law.knob }
  composition { mu law }
}
submodel Law c "law.c" { in knob : double }
submodel Still { out knob : double  knob = 1.0 }
environment Bench for Crash { still : Still  still.knob -> knob }
"""
LAW_H = """\
#pragma once
struct law { double knob; };
void law_initialize(struct law *self);
void law_calculate(struct law *self);
"""
LAW_C = """\
#include "law.h"
#include <stdlib.h>
void law_initialize(struct law *self) { (void)self; }
void law_calculate(struct law *self) { (void)self; abort(); }
"""

pytestmark = needs_compiler


def network_of(name: str) -> CoreNetwork:
    """The network of a model."""
    return load(MODELS / name)._build(None, None, None, alone=True)


def in_python(network: CoreNetwork, until: int | None) -> LiveRun:
    """The run that a native one is compared with."""
    files = pipeline.generate(network, read_source, level=1, traced=True, observed=True)
    return LiveRun(network, files, None, until)


def natively(network: CoreNetwork, until: int | None) -> SteeredRun:
    """A native run."""
    return SteeredRun(build_program(network, read_source, level=1, options=("-O1",)), until)


def recorded(run: LiveRun | SteeredRun) -> tuple[object, ...]:
    """All that a run leaves."""
    found = RunData(run.network, run.environment, run.end(), run.recorder)
    outcome = found.outcome
    missed = {name: count for name, count in outcome.missed.items() if count}
    stuck = outcome.deadlock and outcome.deadlock.text
    return plain_trace_text(found), "".join(csv_parts(found)), outcome.ended, outcome.time, missed, stuck


@pytest.mark.parametrize("way", ["pieces", "steps"])
@pytest.mark.parametrize(
    ("name", "until"),
    [("jiwy/jiwy.csp", 300 * MS), ("dining/deadlock.csp", None), ("watchdog/watchdog.csp", 3000 * MS)],
)
def test_a_native_run_in_pieces_is_the_run_in_python(name: str, until: int | None, way: str) -> None:
    network = network_of(name)
    expected, run = in_python(network, until), natively(network, until)
    chance = random.Random(name + way)
    while run.outcome is None:
        if way == "steps":
            run.communicate(chance.randrange(1, 5), lambda: False)
        else:
            run.advance(run.now + chance.randrange(1, 30 * MS), lambda: chance.random() < 0.01)
        run.waiting(10)
    expected.advance(1 << 62, lambda: False)
    assert recorded(run) == recorded(expected)


def test_it_is_the_same_when_parameters_are_tuned_and_a_button_is_pressed() -> None:
    network = network_of("jiwy/jiwy.csp")
    runs: tuple[LiveRun | SteeredRun, ...] = (in_python(network, 900 * MS), natively(network, 900 * MS))
    at = [parameter.name for parameter in network.parameters if parameter.follows is None].index("panGains")
    gains: Any = network.parameters[at]
    deeds: dict[int, Callable[[LiveRun | SteeredRun], None]] = {
        50: lambda run: run.take("joystick_vertical", 0.5),
        120: lambda run: run.plan(Change(run.now, "panGains", (0,), 3.25)),
        200: lambda run: run.give_back("joystick_vertical"),
        450: lambda run: run.take("joystick_buttons", 2),
        600: lambda run: run.take("joystick_buttons", 0),
    }
    assert gains.name == "panGains"
    for run in runs:
        for instant, deed in deeds.items():
            assert run.advance(instant * MS, lambda: False)
            deed(run)
        run.advance(900 * MS, lambda: False)
    assert runs[0].recorder.changes == runs[1].recorder.changes != []
    assert recorded(runs[0]) == recorded(runs[1])


def notified(target: str, model: dict[str, Any], deeds: list[tuple[int, str, dict[str, Any]]], until: int) -> list[Any]:
    """What a session sends that is stepped from instant to instant."""
    player = Player()
    session = player.ask("start", **model, target=target, until=f"{until} ms")["session"]
    for instant, method, params in deeds:
        player.play(session, instant * MS)
        player.ask(method, session=session, **params)
    player.play(session, until * MS)
    return player.notifications


def test_the_page_sees_the_same() -> None:
    deeds: list[tuple[int, str, dict[str, Any]]] = [
        (20, "input", {"name": "knob", "value": 5}),
        (30, "tune", {"name": "gain", "value": 3}),
        (60, "input", {"name": "knob", "value": None}),
        (70, "input", {"name": "lamps", "value": 7}),
    ]
    expected, found = (notified(target, program(KNOB), deeds, 100) for target in ("python", "c"))
    assert found == expected
    assert found[-1]["params"]["reason"] == "until"


def test_it_is_said_until_when_processes_wait() -> None:
    player = Player()
    seen = []
    for target in ("python", "c"):
        session = player.ask("start", **player.model("buffer"), target=target)["session"]
        player.play(session, 1)
        seen.append(player.ask("state", session=session))
        player.ask("stop", session=session)
    assert seen[0] == seen[1]
    assert {each["for"] for each in seen[0]["waiting"]} > {"until 5 ms"}


def test_a_native_session_is_paused_and_stepped() -> None:
    player = Player()
    started = player.ask("start", **player.model("dining/deadlock"), target="c")
    assert started["target"] == "c"
    session = started["session"]
    now = player.ask("step", session=session)
    assert player.frames[-1]["params"]["communications"][0]["channel"] == "SymmetricTable.philosopher[0].first"
    player.ask("play", session=session, speed=1)
    assert player.ask("pause", session=session) == now
    assert player.ask("state", session=session)["waiting"] != []
    player.ask("stop", session=session)
    assert player.notifications[-1]["params"]["reason"] == "stopped"
    assert "has ended" in player.refused("step", session=session)


def test_a_native_program_that_never_leaves_an_instant_can_be_stopped() -> None:
    player = Player()
    session = player.ask("start", **program(LIVELOCK), target="c")["session"]
    player.ask("play", session=session, speed=0)
    player.engine.proceed()
    assert player.frames[-1]["params"]["omitted"] > 0
    assert player.ask("step", session=session, by="instant") == {"now": 0}
    player.ask("stop", session=session)
    assert player.notifications[-1]["params"]["reason"] == "stopped"


def test_a_native_program_that_crashes_ends_its_session(talk: Talk) -> None:
    talk.ask("start", files={"p.csp": CRASH, "law.c": LAW_C, "law.h": LAW_H}, main="p.csp", target="c")
    talk.ask("play", session=1, speed=0)
    talk.engine.proceed()
    ended = talk.notifications[-1]["params"]
    assert ended["reason"] == "fault"
    assert "the native program has failed: it was ended by SIG" in ended["text"]
    assert "a crash such as that of a body in C" in ended["text"]
    assert "a crash in Crash.law (" in ended["text"]


def test_a_law_in_c_that_does_not_compile_is_not_to_be_run_in_python(talk: Talk) -> None:
    files = {"p.csp": CRASH, "law.c": f"{LAW_C}\nint no end", "law.h": LAW_H}
    refusal = str(talk.answer("start", files=files, main="p.csp", target="c")["error"])
    assert "law.c" in refusal
    assert "run it in Python" not in refusal


def test_what_native_sessions_cannot_do_is_said(talk: Talk, monkeypatch: pytest.MonkeyPatch) -> None:
    assert talk.ask("hello")["able"]["native"]
    assert "python or c" in talk.refused("start", **program(KNOB), target="ada")
    text = KNOB.replace("submodel Still {", 'submodel Still python "still.py:Still" {').replace(
        "  knob = 1.0  lamps = 3", ""
    )
    answer = talk.answer("start", files={"p.csp": text, "still.py": "class Still: pass"}, main="p.csp", target="c")
    assert answer["error"]["help"] == "run it in Python: what happens is the same"
    monkeypatch.setenv("CC", "no-compiler")
    hello = talk.ask("hello")
    assert not hello["able"]["native"]
    assert hello["unable"]["native"] == "CC is no-compiler, and there is no such command"
    assert "no-compiler" in talk.refused("start", **program(KNOB), target="c")
    browser = Engine(lambda method, params: None, kind="browser")
    assert not browser.request({"id": 1, "method": "hello"})["result"]["able"]["native"]


@pytest.mark.parametrize("ending", ["end of input", "SIGTERM", "SIGKILL"])
def test_outputs_of_native_programs_are_released_with_their_engine(tmp_path: Path, ending: str) -> None:
    written = tmp_path / "values"
    (tmp_path / "valve.c").write_text(VALVE_C.replace("PLACE", str(written)))
    (tmp_path / "valve.h").write_text(VALVE_H)
    (tmp_path / "valve.csp").write_text(VALVE)
    engine = subprocess.Popen(
        [sys.executable, "-m", "cspdiag.studio.engine", str(tmp_path / "valve.csp")],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert engine.stdin is not None
    assert engine.stdout is not None
    start = {"files": {"valve.csp": VALVE}, "main": "valve.csp", "target": "c"}
    for method, params in (("start", start), ("play", {"session": 1, "speed": 1})):
        engine.stdin.write(json.dumps({"id": 1, "method": method, "params": params}) + "\n")
        engine.stdin.flush()
        assert "result" in json.loads(engine.stdout.readline())

    def values() -> list[str]:
        return written.read_text().split() if written.exists() else []

    def wait_until(happened: Callable[[], bool]) -> None:
        over = time.monotonic() + 20
        while not happened():
            assert time.monotonic() < over
            time.sleep(0.02)

    wait_until(lambda: "2" in values())
    if ending == "end of input":
        engine.stdin.close()
    else:
        os.kill(engine.pid, signal.Signals[ending])
    rest = [json.loads(line) for line in engine.stdout]
    engine.wait(20)
    wait_until(lambda: values()[-1] == "-1")
    if ending != "SIGKILL":
        assert rest[-1]["params"]["reason"] == "stopped"
    engine.stdin.close()
    engine.stdout.close()
