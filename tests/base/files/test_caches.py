"""What a cache keeps is trusted later, so it is kept where no other user can write."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from cspdiag.base.files.caches import cache_folder
from cspdiag.simulate.native.build import Build, CompilerError
from cspdiag.syntax.parse import tables

pytestmark = pytest.mark.skipif(not hasattr(os, "geteuid"), reason="modes of POSIX")


@pytest.fixture
def base(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path


def test_the_cache_is_made_for_its_user_alone(base: Path) -> None:
    assert cache_folder() == str(base / "cspdiag")
    assert stat.S_IMODE((base / "cspdiag").stat().st_mode) == 0o700


@pytest.mark.parametrize("mode", [0o770, 0o777, 0o702])
def test_a_cache_that_others_can_write_into_is_neither_read_nor_written(base: Path, mode: int) -> None:
    folder = base / "cspdiag"
    folder.mkdir()
    folder.chmod(mode)
    with pytest.raises(PermissionError, match="others may write"):
        cache_folder()
    assert tables.load().words["process"]
    with pytest.raises(CompilerError, match="others may write"):
        Build({"main.c": "int main(void) { return 0; }\n"}, ["main.c"]).executable()
    assert list(folder.iterdir()) == []


def test_a_cache_of_another_user_is_not_used(base: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache_folder()
    monkeypatch.setattr(os, "geteuid", lambda: (base / "cspdiag").stat().st_uid + 1)
    with pytest.raises(PermissionError):
        cache_folder()


def test_a_relative_path_is_ignored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    assert cache_folder() == str(tmp_path / ".cache" / "cspdiag")
    assert not (tmp_path / "relative").exists()
