"""Several pages see one program, one of them controls it, and it ends safely when that page goes."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from tests.studio.server.running_studio import Studio


def test_errors_of_engines_are_passed_on(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        page = studio.open()
        with pytest.raises(RuntimeError, match="no"):
            page.ask("format")


def test_an_engine_that_ends_is_replaced(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        page = studio.open()
        with pytest.raises(RuntimeError, match="ended before it answered"):
            page.ask("explain")
        assert page.ask("check")["method"] == "check"


def test_why_an_engine_cannot_be_started_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    async def refused(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied", "/usr/bin/python3")

    async def broken(*_: object, **__: object) -> None:
        raise ValueError("a surprise")

    with Studio(tmp_path) as studio:
        page = studio.open()
        with monkeypatch.context() as without:
            without.setattr("asyncio.create_subprocess_exec", refused)
            with pytest.raises(RuntimeError, match=r"no process can be started for the engine: .*permission denied"):
                page.ask("hello")
            without.setattr("asyncio.create_subprocess_exec", broken)
            with pytest.raises(RuntimeError, match="cspdiag failed: ValueError: a surprise"):
                page.ask("hello")
        assert page.ask("hello")["hand"]


def test_the_first_page_controls_and_others_see(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        first, second = studio.open(), studio.open()
        assert first.ask("hello")["hand"]
        assert second.ask("hello") == {
            "able": {"save": True},
            "program": {"files": {"a.csp": "process A() = SKIP\n"}, "main": "a.csp"},
            "hand": False,
            "page": 2,
            "held_by": 1,
            "viewers": 2,
        }
        with pytest.raises(RuntimeError, match="another page controls"):
            second.ask("start")
        first.ask("start", files={"a.csp": "text"}, main="a.csp", own=True)
        assert second.wait_for("started") == {"files": {"a.csp": "text"}, "main": "a.csp", "own": True, "session": "1"}
        first.ask("play", session="1")
        assert first.wait_for("frame")["session"] == second.wait_for("frame")["session"] == "1"
        third = studio.open()
        assert third.ask("hello")["running"]["session"] == "1"


def test_control_can_be_taken(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        first, second = studio.open(), studio.open()
        second.ask("take_hand")
        second.ask("start")
        with pytest.raises(RuntimeError, match="another page controls"):
            first.ask("stop")


def test_the_program_is_stopped_when_the_page_that_controls_it_goes(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        first, second = studio.open(), studio.open()
        first.ask("start")
        first.ask("play", session="1")
        first.close()
        ended = second.wait_for("ended")
        assert ended["reason"] == "stopped"
        assert "closed" in ended["text"]
        assert studio.released
        assert second.ask("hello")["hand"]
        second.ask("start")


def test_a_program_that_does_not_answer_is_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cspdiag.studio.server.room.PATIENCE_TO_STOP", 0.1)
    monkeypatch.setattr("cspdiag.studio.server.engines._PATIENCE", 0.2)
    with Studio(tmp_path) as studio:
        page = studio.open()
        page.ask("start")
        assert page.ask("stop", session="1", seconds=60) == {}
        (ended,) = [each["params"] for each in page.notifications if each["method"] == "ended"]
        assert "has computed for 0.1 s without a communication" in ended["text"]
        page.ask("start")


def test_pages_learn_when_the_engine_of_the_program_ends(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        first, second = studio.open(), studio.open()
        first.ask("start")
        with pytest.raises(RuntimeError, match="ended before it answered"):
            first.ask("step")
        ended = second.wait_for("ended")
        assert (ended["session"], ended["reason"]) == ("1", "fault")
        assert "running" not in second.ask("hello")
        first.ask("start")


def test_a_run_that_ends_at_once_has_begun_before(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        first, second = studio.open(), studio.open()
        first.ask("start", ends=True)
        first.wait_for("ended")
        second.wait_for("ended")
        assert [each["method"] for each in second.notifications][-2:] == ["started", "ended"]
        assert "ended" not in [each["method"] for each in first.notifications[:-1]]
        assert "running" not in second.ask("hello")


def test_the_program_is_stopped_when_the_server_ends(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        page = studio.open()
        page.ask("start")
        page.ask("play", session="1")
        studio.end()
        assert studio.released


def test_long_work_does_not_delay_questions_and_can_be_cancelled(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        first, second = studio.open(), studio.open()
        first.socket.send('{"id": 77, "method": "verify", "params": {"seconds": 60}}')
        began = time.monotonic()
        assert second.ask("check")["method"] == "check"
        second.ask("cancel")
        answer = first.receive()
        while "id" not in answer:
            answer = first.receive()
        assert answer["id"] == 77
        assert "error" in answer
        assert time.monotonic() - began < 50


def test_a_page_that_reads_nothing_slows_nobody(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        slow = studio.open(max_queue=1)
        fast = studio.open()
        fast.ask("take_hand")
        fast.ask("start")
        fast.ask("play", session="1")
        last = 0
        while last < 3_000_000_000:
            frame = fast.wait_for("frame")
            assert frame["from"] == last or last == 0
            assert "thinned" not in frame
            last = frame["to"] + 1_000_000
        viewer = studio.room.viewers[0]
        assert viewer.waiting < 50
        received = 0
        while received < last - 1_000_000:
            received = slow.wait_for("frame")["to"]
