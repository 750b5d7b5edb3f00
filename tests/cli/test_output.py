"""Generated files are written whole or not at all, and never over what was made by hand."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from cspdiag.cli import output
from cspdiag.cli.failure import UsageError
from cspdiag.cli.output import MANIFEST, replace_text, write_new_folder, write_package

FILES = {"README.md": "read\n", "arm/__init__.py": "", "arm/network.py": "first\n"}


def contents(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): path.read_text()
        for path in folder.rglob("*")
        if path.is_file() and path.name != MANIFEST
    }


def test_a_package_is_written_and_written_again(tmp_path: Path) -> None:
    folder = tmp_path / "out" / "arm"
    write_package(str(folder), FILES, force=False)
    assert contents(folder) == FILES
    later = {**FILES, "arm/network.py": "second\n"}
    write_package(str(folder), later, force=False)
    assert contents(folder) == later
    assert os.listdir(folder.parent) == ["arm"]


def test_a_file_changed_by_hand_is_not_overwritten(tmp_path: Path) -> None:
    folder = tmp_path / "arm"
    write_package(str(folder), FILES, force=False)
    (folder / "arm/network.py").write_text("mine\n")
    before = contents(folder)
    with pytest.raises(UsageError, match=r"arm/network\.py.*--force"):
        write_package(str(folder), {**FILES, "README.md": "new\n"}, force=False)
    assert contents(folder) == before
    write_package(str(folder), FILES, force=True)
    assert contents(folder) == FILES


def test_a_folder_of_somebody_else_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text("mine\n")
    with pytest.raises(UsageError, match=r"README\.md"):
        write_package(str(tmp_path), FILES, force=False)
    assert contents(tmp_path) == {"README.md": "mine\n"}


def test_files_that_were_added_stay_and_files_no_longer_generated_go(tmp_path: Path) -> None:
    write_package(str(tmp_path), FILES, force=False)
    (tmp_path / "arm/notes.txt").write_text("mine\n")
    write_package(str(tmp_path), {"README.md": "read\n"}, force=False)
    assert contents(tmp_path) == {"README.md": "read\n", "arm/notes.txt": "mine\n"}


def test_a_file_no_longer_generated_but_changed_by_hand_stays(tmp_path: Path) -> None:
    write_package(str(tmp_path), FILES, force=False)
    (tmp_path / "arm/network.py").write_text("mine\n")
    with pytest.raises(UsageError):
        write_package(str(tmp_path), {"README.md": "read\n"}, force=False)
    assert (tmp_path / "arm/network.py").read_text() == "mine\n"


def test_a_manifest_cannot_name_files_elsewhere(tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    outside.write_text("mine\n")
    folder = tmp_path / "arm"
    write_package(str(folder), FILES, force=False)
    with (folder / MANIFEST).open("a") as manifest:
        manifest.write(f"0  ../outside\n0  {outside}\n")
    write_package(str(folder), FILES, force=False)
    assert outside.read_text() == "mine\n"


def test_a_failure_leaves_what_was_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "arm"
    write_package(str(folder), FILES, force=False)

    def full(path: str, text: str) -> None:
        if path.endswith("network.py"):
            raise OSError(28, "No space left on device", path)
        original(path, text)

    original = output._write
    monkeypatch.setattr(output, "_write", full)
    with pytest.raises(OSError, match="No space"):
        write_package(str(folder), dict.fromkeys(FILES, "new\n"), force=False)
    with pytest.raises(OSError, match="No space"):
        write_new_folder(str(tmp_path / "fresh"), FILES)
    assert contents(folder) == FILES
    assert os.listdir(tmp_path) == ["arm"]


def test_replacing_keeps_the_link_and_the_mode(tmp_path: Path) -> None:
    target = tmp_path / "target"
    target.write_text("old")
    target.chmod(0o640)
    link = tmp_path / "link"
    link.symlink_to(target)
    replace_text(str(link), "new")
    assert link.is_symlink()
    assert target.read_text() == "new"
    assert target.stat().st_mode & 0o777 == 0o640
