"""The engine as it runs in a browser: Python as WebAssembly in a worker, here in node. `make playground` builds it."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from cspdiag import load
from tests.studio.talking import JIWY, Talk

STUDIO = Path(__file__).parents[2] / "studio"
WORKER = STUDIO / "build" / "worker.js"
ENGINE = STUDIO / "build" / "engine" / "cspdiag.zip"

pytestmark = pytest.mark.skipif(
    shutil.which("node") is None or not WORKER.exists() or not ENGINE.exists(),
    reason="needs node and what `make playground` builds",
)


class Browser:
    """The worker, asked line by line."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            ["node", "--no-warnings", str(STUDIO / "test" / "worker" / "drive.mjs")],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        self._number = 0
        self.notifications: list[dict[str, Any]] = []

    def ask(self, method: str, **params: Any) -> Any:
        """The result of a request."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._number += 1
        self._process.stdin.write(json.dumps({"id": self._number, "method": method, "params": params}) + "\n")
        self._process.stdin.flush()
        for line in self._process.stdout:
            message = json.loads(line)
            if message.get("id") == self._number:
                assert "error" not in message, message
                return message["result"]
            self.notifications.append(message)
        raise AssertionError("the worker has ended")

    def close(self) -> None:
        """End it."""
        self._process.kill()
        self._process.communicate()


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    found = Browser()
    yield found
    found.close()


@pytest.fixture(scope="module")
def jiwy() -> dict[str, Any]:
    return Talk().model("jiwy")


def test_it_says_what_it_can_do(browser: Browser) -> None:
    found = browser.ask("hello")
    assert found["engine"] == "browser"
    assert not found["able"]["numpy"]


def test_check_and_draw_are_those_of_the_machine(browser: Browser, jiwy: dict[str, Any]) -> None:
    pytest.importorskip("quickjs")
    machine = Talk()
    assert browser.ask("check", **jiwy) == machine.ask("check", **jiwy)
    for view in ("communication", "composition"):
        assert browser.ask("draw", **jiwy, view=view, depth=2) == machine.ask("draw", **jiwy, view=view, depth=2)


def test_a_recording_is_the_same_to_the_byte(browser: Browser, jiwy: dict[str, Any], tmp_path: Path) -> None:
    load(JIWY).run(until="300 ms").to_csv(tmp_path / "run.csv")
    assert browser.ask("run", **jiwy, until="300 ms")["csv"] == (tmp_path / "run.csv").read_text()


@pytest.mark.parametrize("target", ["python", "c", "fmu", "promela", "cspm"])
def test_packages_are_the_same(browser: Browser, target: str) -> None:
    model = Talk().model("watchdog")
    assert browser.ask("compile", **model, target=target, level=1) == Talk().ask(
        "compile", **model, target=target, level=1
    )


@pytest.mark.parametrize("name", ["jiwy", "dining/deadlock", "emergency", "ring", "cascade"])
def test_assertions_get_the_same_verdicts(browser: Browser, name: str) -> None:
    model = Talk().model(name)
    verdicts = [
        [(answer["assertion"], answer["verdict"], bool(answer["suggestions"])) for answer in found]
        for found in (browser.ask("verify", **model), Talk().ask("verify", **model))
    ]
    assert verdicts[0] == verdicts[1]


def test_a_refinement_gets_the_same_answer(browser: Browser) -> None:
    folder = JIWY.parent
    files = {path.name: path.read_text() for path in folder.glob("*.csp")}
    model = {"files": files, "main": "stolen_button.csp"}
    for (answer,) in (browser.ask("verify", **model), Talk().ask("verify", **model)):
        assert answer["verdict"] == "fails"
        assert "where the specification allows only the end" in answer["text"]
        assert answer["counterexample"]["steps"]


def test_timing_is_the_same(browser: Browser, jiwy: dict[str, Any]) -> None:
    assert browser.ask("timing", **jiwy) == Talk().ask("timing", **jiwy)


def test_a_session_plays(browser: Browser, jiwy: dict[str, Any]) -> None:
    session = browser.ask("start", **jiwy)["session"]
    browser.ask("input", session=session, name="joystick_vertical", value=0.5)
    browser.ask("step", session=session, by="instant", count=5)
    frame = browser.notifications[-1]["params"]
    assert frame["signals"]["joystick_vertical"]["v"] == [0.5] * 5
    browser.ask("play", session=session, speed=1)
    count = len(browser.notifications)
    while len(browser.notifications) < count + 2:
        browser.ask("state", session=session)
    assert browser.ask("stop", session=session)["now"] > 5_000_000
