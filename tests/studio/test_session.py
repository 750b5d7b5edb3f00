"""Live sessions: a program that runs in pieces, while inputs are taken over and parameters changed."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from cspdiag import load, pipeline
from cspdiag.base.sources import read_source
from cspdiag.simulate.record.files import csv_parts, plain_trace_text
from cspdiag.simulate.record.run_data import RunData
from cspdiag.simulate.run import execute
from cspdiag.simulate.run.live import LiveRun
from tests.studio.talking import JIWY, MODELS, Talk, program

LIVELOCK = """\
process A { out x : int  composition { mu x ! 1 } }
process B { in y : int  communication { var v : int = 0 }  composition { mu y ? v } }
process Main {
  communication { a : A  b : B  a.x -> b.y }
  composition { a || b }
}
"""

LEFT_ALONE = """\
process Short { out o : int  composition { o ! 1 } }
process Long { in i : int  communication { var n : int = 0 }  composition { i ? n ; i ? n } }
process Main {
  communication { a : Short  b : Long  a.o -> b.i }
  composition { a || b }
}
"""
KNOB = """\
parameter gain = 2.0
process Scale {
  in  knob  : double @ 10 ms
  in  lamps : int8
  out level : double @ 10 ms safe 0.0
  communication { var x : double = 0.0 }
  composition { mu (knob ? x ; level ! gain * x) }
}
submodel Still { out knob : double  out lamps : int8  knob = 1.0  lamps = 3 }
submodel Sink { in level : double }
environment Bench for Scale {
  still : Still
  sink : Sink
  still.knob -> knob
  still.lamps -> lamps
  level -> sink.level
}
"""


def live(name: str, level: int, until: int | None) -> tuple[LiveRun, RunData]:
    """A live run, and the same run at once."""
    network = load(MODELS / name)._build(None, None, None, alone=True)
    files = pipeline.generate(network, read_source, level=level, traced=True, observed=True)
    return LiveRun(network, files, None, until), execute.simulate(network, files, until=until)


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("way", ["pieces", "steps"])
@pytest.mark.parametrize(
    ("name", "until"),
    [
        ("jiwy/jiwy.csp", 300),
        ("dining/deadlock.csp", None),
        ("emergency/emergency.csp", 400),
        ("watchdog/watchdog.csp", 3000),
        ("buffer/buffer.csp", 300),
        ("cascade/cascade.csp", 100),
        ("commstime/commstime.csp", None),
    ],
)
def test_a_run_in_pieces_is_the_same_run(name: str, until: int | None, way: str, level: int) -> None:
    run, expected = live(name, level, None if until is None else until * 1_000_000)
    chance = random.Random(name + way)
    while run.outcome is None:
        if way == "steps":
            run.step(lambda: chance.random() < 0.3)
        else:
            run.advance(run.now + chance.randrange(1, 30_000_000), lambda: chance.random() < 0.01)
    found = RunData(run.network, run.environment, run.end(), run.recorder)
    assert plain_trace_text(found) == plain_trace_text(expected)
    assert "".join(csv_parts(found)) == "".join(csv_parts(expected))
    assert (found.outcome.ended, found.outcome.time) == (expected.outcome.ended, expected.outcome.time)
    assert found.outcome.missed == expected.outcome.missed
    deadlocks = [outcome.deadlock and outcome.deadlock.text for outcome in (found.outcome, expected.outcome)]
    assert deadlocks[0] == deadlocks[1]


class Player(Talk):
    """An engine that plays without waiting for the clock."""

    def play(self, session: int, until: int) -> None:
        """Step from instant to instant."""
        while self.ask("step", session=session, by="instant")["now"] < until:
            pass

    def shown(self, name: str) -> tuple[list[int], list[Any]]:
        """What the frames have of a signal."""
        parts = [each["params"]["signals"].get(name, {"t": [], "v": []}) for each in self.frames]
        return [time for part in parts for time in part["t"]], [value for part in parts for value in part["v"]]

    @property
    def frames(self) -> list[dict[str, Any]]:
        return [each for each in self.notifications if each["method"] == "frame"]


@pytest.fixture
def player() -> Player:
    return Player()


def test_a_session_says_what_there_is_to_see(player: Player) -> None:
    found = player.ask("start", **player.model("jiwy"))
    assert (found["environment"], found["top"], found["until"]) == ("Bench", "Jiwy", None)
    signals = {signal["name"]: signal for signal in found["signals"]}
    assert signals["joystick_vertical"]["hand"]
    assert not signals["control_vertical"]["hand"]
    assert signals["feedback_vertical"]["unit"] == "rad"
    assert {"path": "Jiwy.horizontal.alignL", "name": "Align"} in found["processes"]
    assert found["groups"][0]["modes"]["Jiwy.horizontal.alignL"] == "alignL"
    fields = [field["name"] for parameter in found["parameters"] for field in parameter["fields"]]
    assert "panGains.kp" in fields


def test_frames_follow_each_other_and_have_the_whole_run(player: Player) -> None:
    session = player.ask("start", **player.model("jiwy"), until="50 ms")["session"]
    player.play(session, 50_000_000)
    for before, after in pairwise(player.frames):
        assert before["params"]["to"] == after["params"]["from"]
    expected = load(JIWY).run(until="50 ms")
    for name in ("feedback_vertical", "control_vertical", "control_horizontal"):
        times, values = player.shown(name)
        assert values == list(expected[name])
        assert times == [round(time * 1e9) for time in expected.time(name)]
    assert player.frames[0]["params"]["started"][:2] == ["Jiwy", "Jiwy.horizontal"]
    assert player.frames[0]["params"]["modes"][0] == {
        "t": 0, "group": "horizontal", "path": "Jiwy.horizontal.alignL", "mode": "alignL",
    }  # fmt: skip
    (ended,) = [each["params"] for each in player.notifications if each["method"] == "ended"]
    assert (ended["reason"], ended["at"]) == ("until", 50_000_000)
    assert "has ended" in player.refused("play", session=session)
    assert "has ended" in player.refused("step", session=session)


def test_a_mode_is_left_when_its_process_ends(player: Player) -> None:
    text = """process Once { composition { wait 20 ms } }
process Two {
  communication { one : Once  two : Once }
  composition { one ; wait 10 ms ; two ; wait 10 ms }
}
"""
    session = player.ask("start", **program(text))["session"]
    player.play(session, 60_000_000)
    modes = [each for frame in player.frames for each in frame["params"]["modes"]]
    assert [(each["t"] // 1_000_000, each["path"], each["mode"]) for each in modes] == [
        (0, "Two.one", "one"), (20, "Two.one", None), (30, "Two.two", "two"), (50, "Two.two", None),
    ]  # fmt: skip


def test_a_step_is_a_communication(player: Player) -> None:
    session = player.ask("start", **player.model("dining/deadlock"))["session"]
    player.ask("step", session=session)
    (communication,) = player.frames[-1]["params"]["communications"]
    assert communication["channel"] == "SymmetricTable.philosopher[0].first"
    player.ask("step", session=session, count=3)
    assert len(player.frames[-1]["params"]["communications"]) == 3
    state = player.ask("state", session=session)
    assert not state["playing"]
    waiting = {each["process"]: each for each in state["waiting"]}
    assert waiting["SymmetricTable.philosopher[4]"]["channels"] == ["SymmetricTable.philosopher[4].first"]
    player.ask("play", session=session, speed=1)
    assert player.ask("state", session=session)["playing"]


def test_a_deadlock_is_seen(player: Player) -> None:
    session = player.ask("start", **player.model("dining/deadlock"))["session"]
    while not [each for each in player.notifications if each["method"] == "ended"]:
        player.ask("step", session=session, by="instant")
    ended = player.notifications[-1]["params"]
    assert (ended["reason"], ended["at"], len(ended["ring"])) == ("deadlock", 10_000_000, 10)
    assert ended["waiting"][0]["for"] == "to write SymmetricTable.philosopher[0].second"
    assert ended["waiting"][0]["why"] == ""


def test_what_no_process_does_any_more_is_said(player: Player) -> None:
    session = player.ask("start", **program(LEFT_ALONE))["session"]
    player.ask("step", session=session, by="instant")
    ended = player.notifications[-1]["params"]
    assert ended["reason"] == "deadlock"
    (waiting,) = ended["waiting"]
    assert (waiting["for"], waiting["why"]) == ("to read Main.a.o", "; no other process that still runs writes to it")


def test_a_hand_takes_over_an_input_and_gives_it_back(player: Player) -> None:
    session = player.ask("start", **program(KNOB))["session"]
    player.play(session, 30_000_000)
    player.ask("input", session=session, name="knob", value=5)
    player.play(session, 60_000_000)
    player.ask("input", session=session, name="knob", value=None)
    player.play(session, 90_000_000)
    assert player.shown("knob")[1] == [1.0] * 3 + [5.0] * 3 + [1.0] * 3
    assert player.shown("level")[1] == [2.0] * 3 + [10.0] * 3 + [2.0] * 2


def test_a_parameter_changes_at_the_next_instant(player: Player) -> None:
    session = player.ask("start", **program(KNOB))["session"]
    player.play(session, 20_000_000)
    player.ask("tune", session=session, name="gain", value=3)
    player.play(session, 60_000_000)
    assert player.shown("level")[1][-1] == 3.0
    (change,) = [change for frame in player.frames for change in frame["params"]["changes"]]
    assert change["parameter"] == "gain"
    assert "no" in player.refused("tune", session=session, name="nothing", value=1)
    assert "`value`" in player.refused("tune", session=session, name="gain", value=[1])


def test_the_same_inputs_at_the_same_instants_give_the_same_trace() -> None:
    def played() -> list[Any]:
        player = Player()
        session = player.ask("start", **player.model("jiwy"), until="80 ms")["session"]
        for instant, value in ((20, 0.5), (40, -0.7), (60, None)):
            player.play(session, instant * 1_000_000)
            player.ask("input", session=session, name="joystick_vertical", value=value)
        player.play(session, 80_000_000)
        return [frame["params"] for frame in player.frames]

    assert played() == played()


@pytest.mark.parametrize(
    ("method", "params", "words"),
    [
        ("input", {"name": "level", "value": 1}, "no input 'level'"),
        ("input", {"name": "knob", "value": "x"}, "not a value of the input `knob`"),
        ("input", {"name": "knob", "value": True}, "not a value"),
        ("input", {"name": "lamps", "value": 128}, "which is int8"),
        ("input", {"name": "lamps", "value": 1.5}, "which is int8"),
        ("input", {"name": ["knob"], "value": 1}, "no input"),
        ("play", {"speed": -1}, "`speed`"),
        ("play", {"speed": "fast"}, "`speed`"),
        ("step", {"by": "year"}, "`by`"),
        ("step", {"count": 0}, "`count`"),
        ("state", {"session": 9}, "no such session"),
    ],
)
def test_what_is_wrong_is_said(player: Player, method: str, params: dict, words: str) -> None:
    session = player.ask("start", **program(KNOB))["session"]
    message = player.refused(method, **{"session": session, **params})
    assert words in message
    assert "cspdiag failed" not in message


def test_a_program_that_never_leaves_an_instant_can_be_paused_and_stopped(
    player: Player, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cspdiag.studio.engine.live.session._PATIENCE", 0.05)
    session = player.ask("start", **program(LIVELOCK))["session"]
    player.ask("play", session=session, speed=0)
    player.engine.proceed()
    assert player.frames[-1]["params"]["omitted"] > 0
    assert player.ask("step", session=session, by="instant") == {"now": 0}
    player.ask("stop", session=session)
    assert player.notifications[-1]["params"]["reason"] == "stopped"


def test_play_follows_the_clock(player: Player) -> None:
    session = player.ask("start", **program(KNOB))["session"]
    assert player.engine.due() is None
    player.ask("play", session=session, speed=1000)
    began = time.perf_counter()
    while player.ask("state", session=session)["now"] == 0:
        time.sleep(player.engine.due() or 0)
        player.engine.proceed()
    assert player.ask("pause", session=session)["now"] <= (time.perf_counter() - began) * 1000 * 1e9
    assert player.engine.due() is None


def test_a_fault_of_the_environment_ends_the_session(player: Player) -> None:
    text = KNOB.replace("knob = 1.0", "knob = 1.0 / (0.02 - time / 1<s>)")
    session = player.ask("start", **program(text))["session"]
    while player.notifications == [] or player.notifications[-1]["method"] != "ended":
        player.ask("step", session=session, by="instant")
    assert player.notifications[-1]["params"]["reason"] == "fault"


def test_a_new_session_ends_the_last_one(player: Player) -> None:
    first = player.ask("start", **program(KNOB))["session"]
    second = player.ask("start", **program(KNOB))["session"]
    assert first != second
    assert player.notifications[-1]["params"] == {**player.notifications[-1]["params"], "reason": "stopped"}
    assert "errors" in player.refused("start", **program("process P { in a : nothing }"))


@pytest.mark.parametrize("ending", ["end of input", "SIGTERM", "SIGINT"])
def test_a_session_ends_with_its_engine(tmp_path: Path, ending: str) -> None:
    file = tmp_path / "knob.csp"
    file.write_text(KNOB)
    process = subprocess.Popen(
        [sys.executable, "-m", "cspdiag.studio.engine", str(file)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdin is not None
    assert process.stdout is not None

    def ask(method: str, **params: object) -> None:
        assert process.stdin is not None
        process.stdin.write(json.dumps({"id": 1, "method": method, "params": params}) + "\n")
        process.stdin.flush()

    ask("hello")
    opened = json.loads(process.stdout.readline())["result"]["program"]
    assert opened == {"files": {"knob.csp": KNOB}, "main": "knob.csp"}
    ask("start", **opened)
    ask("play", session=1, speed=1)
    messages = [json.loads(process.stdout.readline()) for _ in range(4)]
    assert messages[-1]["method"] == "frame"
    if ending == "end of input":
        process.stdin.close()
    else:
        os.kill(process.pid, signal.Signals[ending])
    rest = [json.loads(line) for line in process.stdout]
    assert rest[-1]["params"]["reason"] == "stopped"
    process.wait(10)
    process.stdout.close()
