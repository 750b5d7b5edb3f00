"""The studio saves the files of its program, and nothing else."""

from __future__ import annotations

import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from cspdiag.studio.engine.program_file import ProgramFile
from cspdiag.studio.server.saved_files import SavedFiles
from tests.studio.server.running_studio import Studio

BEFORE = "process A() = SKIP\n"


def _saved(page: Any, file: object, text: object, before: object = BEFORE) -> str:
    try:
        page.ask("save", file=file, text=text, before=before)
    except RuntimeError as problem:
        return str(problem)
    return "saved"


def test_a_file_is_saved_as_often_as_one_likes(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        page = studio.open()
        page.ask("hello")
        texts = (BEFORE, "process B() = SKIP\n", "process C() = SKIP\n")
        for before, text in pairwise(texts):
            assert _saved(page, "a.csp", text, before) == "saved"
            assert studio.program.read_text(encoding="utf-8") == text


def test_line_ends_of_the_file_are_kept(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        studio.program.write_bytes(b"a\r\nb\r\n")
        page = studio.open()
        page.ask("hello")
        assert _saved(page, "a.csp", "a\nc\n", "a\nb\n") == "saved"
        assert studio.program.read_bytes() == b"a\r\nc\r\n"


def test_a_file_that_was_changed_meanwhile_is_not_overwritten(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        page = studio.open()
        page.ask("hello")
        studio.program.write_text("changed\n", encoding="utf-8")
        studio.open().ask("hello")
        assert "has changed on disk" in _saved(page, "a.csp", "x")
        assert studio.program.read_text(encoding="utf-8") == "changed\n"


def test_pages_learn_what_others_write_and_what_is_saved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cspdiag.studio.server.room.BETWEEN_LOOKS", 0.02)
    with Studio(tmp_path) as studio:
        first, second = studio.open(), studio.open()
        first.ask("hello")

        def wait_for(text: str) -> None:
            for page in (first, second):
                while page.wait_for("on_disk") != {"files": {"a.csp": text}, "main": "a.csp"}:
                    pass

        wait_for(BEFORE)
        studio.program.write_text("by others\n", encoding="utf-8")
        wait_for("by others\n")
        assert _saved(first, "a.csp", "saved\n", "by others\n") == "saved"
        wait_for("saved\n")
        studio.program.rename(tmp_path / "away")
        time.sleep(0.1)
        (tmp_path / "away").write_text("back\n", encoding="utf-8")
        (tmp_path / "away").rename(studio.program)
        wait_for("back\n")


def test_a_file_that_comes_back_is_news(tmp_path: Path) -> None:
    part = tmp_path / "part.csp"
    for path in (tmp_path / "a.csp", part):
        path.write_text(BEFORE, encoding="utf-8")
    files = SavedFiles(ProgramFile(str(tmp_path / "a.csp")))

    def news() -> bool:
        files.look()
        found = files.look()
        files.note()
        return found

    files.opened({"main": "a.csp", "files": {"a.csp": "", "part.csp": ""}})
    assert news()
    part.unlink()
    assert news()
    files.opened({"main": "a.csp", "files": {"a.csp": ""}})
    assert not news()
    part.write_text(BEFORE, encoding="utf-8")
    assert news()
    files.save("part.csp", "process B() = SKIP\n", BEFORE)
    assert part.read_text(encoding="utf-8") == "process B() = SKIP\n"


@pytest.mark.parametrize("file", ["../a.csp", "/etc/passwd", "page/index.html", "", None, 5, "a.csp\0"])
def test_other_files_are_refused(tmp_path: Path, file: object) -> None:
    with Studio(tmp_path) as studio:
        page = studio.open()
        page.ask("hello")
        assert _saved(page, file, "x") != "saved"


def test_what_is_no_text_is_refused(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        page = studio.open()
        page.ask("hello")
        assert "surrogate" in _saved(page, "a.csp", "\ud800")
        assert _saved(page, "a.csp", 5) == "`file` and `text` are texts"
