"""Generated files are written whole or not at all, and never over files made by hand."""

from __future__ import annotations

import os
from hashlib import sha256
from pathlib import Path

import pytest

from cspdiag.cli.support.failure import UsageError
from cspdiag.cli.support.files import output
from cspdiag.cli.support.files.manifest import manifest_name
from cspdiag.cli.support.files.output import replace_text, write_new_folder, write_package

MANIFEST = manifest_name("python")
FILES = {"README.md": "read\n", "arm/__init__.py": "", "arm/network.py": "first\n"}


def contents(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): path.read_text()
        for path in folder.rglob("*")
        if path.is_file() and path.name != MANIFEST
    }


def test_a_package_is_written_and_written_again(tmp_path: Path) -> None:
    folder = tmp_path / "out" / "arm"
    write_package(str(folder), FILES, "python", force=False)
    assert contents(folder) == FILES
    later = {**FILES, "arm/network.py": "second\n"}
    write_package(str(folder), later, "python", force=False)
    assert contents(folder) == later
    assert os.listdir(folder.parent) == ["arm"]


def test_a_file_changed_by_hand_is_not_overwritten(tmp_path: Path) -> None:
    folder = tmp_path / "arm"
    write_package(str(folder), FILES, "python", force=False)
    (folder / "arm/network.py").write_text("mine\n")
    before = contents(folder)
    with pytest.raises(UsageError, match=r"arm/network\.py.*--force"):
        write_package(str(folder), {**FILES, "README.md": "new\n"}, "python", force=False)
    assert contents(folder) == before
    write_package(str(folder), FILES, "python", force=True)
    assert contents(folder) == FILES


def test_a_foreign_folder_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text("mine\n")
    with pytest.raises(UsageError, match=r"README\.md"):
        write_package(str(tmp_path), FILES, "python", force=False)
    assert contents(tmp_path) == {"README.md": "mine\n"}


def test_added_files_stay_and_files_no_longer_generated_are_removed(tmp_path: Path) -> None:
    write_package(str(tmp_path), FILES, "python", force=False)
    (tmp_path / "arm/notes.txt").write_text("mine\n")
    write_package(str(tmp_path), {"README.md": "read\n"}, "python", force=False)
    assert contents(tmp_path) == {"README.md": "read\n", "arm/notes.txt": "mine\n"}


def test_empty_folders_are_removed_and_others_stay(tmp_path: Path) -> None:
    modules = {f"arm/{name}/part.py": "part\n" for name in ("kernel/inner", "ports", "extra")}
    write_package(str(tmp_path), {**FILES, **modules}, "python", force=False)
    (tmp_path / "arm/extra/notes").mkdir()
    for folder in ("kernel/inner", "ports"):
        (tmp_path / "arm" / folder / "__pycache__").mkdir()
        (tmp_path / "arm" / folder / "__pycache__/part.cpython-311.pyc").write_bytes(b"kept by Python")
    (tmp_path / "arm/ports/__pycache__/mine.cpython-311.pyc").write_bytes(b"of another module")
    write_package(str(tmp_path), FILES, "python", force=False)
    left = {path.relative_to(tmp_path / "arm").as_posix() for path in (tmp_path / "arm").rglob("*")}
    assert left == {
        "__init__.py", "network.py", "extra", "extra/notes", "ports", "ports/__pycache__",
        "ports/__pycache__/mine.cpython-311.pyc",
    }  # fmt: skip


@pytest.mark.parametrize("moves", range(5))
def test_files_of_an_interrupted_generation_are_known_as_generated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, moves: int
) -> None:
    write_package(str(tmp_path / "arm"), {**FILES, "arm/old.py": "old\n"}, "python", force=False)
    left = moves

    def broken_off(source: str, target: str) -> None:
        nonlocal left
        if left == 0:
            raise KeyboardInterrupt
        left -= 1
        original(source, target)

    original = os.replace
    monkeypatch.setattr(os, "replace", broken_off)
    with pytest.raises(KeyboardInterrupt):
        write_package(str(tmp_path / "arm"), dict.fromkeys(FILES, "second\n"), "python", force=False)
    monkeypatch.undo()
    third = dict.fromkeys(FILES, "third\n")
    write_package(str(tmp_path / "arm"), third, "python", force=False)
    assert contents(tmp_path / "arm") == third
    assert os.listdir(tmp_path) == ["arm"]
    (tmp_path / "arm/README.md").write_text("second\n")
    with pytest.raises(UsageError, match="changed by hand"):
        write_package(str(tmp_path / "arm"), FILES, "python", force=False)


def test_a_file_no_longer_generated_but_changed_by_hand_stays(tmp_path: Path) -> None:
    write_package(str(tmp_path), FILES, "python", force=False)
    (tmp_path / "arm/network.py").write_text("mine\n")
    with pytest.raises(UsageError):
        write_package(str(tmp_path), {"README.md": "read\n"}, "python", force=False)
    assert (tmp_path / "arm/network.py").read_text() == "mine\n"


def test_a_failure_keeps_the_existing_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "arm"
    write_package(str(folder), FILES, "python", force=False)

    def full(path: str, text: str) -> None:
        if path.endswith("network.py"):
            raise OSError(28, "No space left on device", path)
        original(path, text)

    original = output._write
    monkeypatch.setattr(output, "_write", full)
    with pytest.raises(OSError, match="No space"):
        write_package(str(folder), dict.fromkeys(FILES, "new\n"), "python", force=False)
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


def assert_untouched(elsewhere: Path) -> None:
    assert {path.name: path.read_text() for path in elsewhere.iterdir()} == {"network.py": "of another program\n"}


@pytest.fixture
def elsewhere(tmp_path: Path) -> Path:
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    (folder / "network.py").write_text("of another program\n")
    return folder


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize("link", ["arm", "arm/arm"])
def test_nothing_is_written_or_removed_through_a_link(tmp_path: Path, elsewhere: Path, link: str, force: bool) -> None:
    folder = tmp_path / "arm"
    if link != "arm":
        write_package(str(folder), FILES, "python", force=False)
        for path in (folder / "arm").iterdir():
            path.unlink()
        (tmp_path / link).rmdir()
    (tmp_path / link).symlink_to(elsewhere)
    for files in (FILES, {"README.md": "read\n"}):
        with pytest.raises(UsageError, match=r"symbolic link"):
            write_package(str(folder), files, "python", force=force)
    assert_untouched(elsewhere)
    assert not list(tmp_path.glob("*.tmp"))


def test_a_linked_file_of_a_package_is_one_changed_by_hand(tmp_path: Path, elsewhere: Path) -> None:
    folder = tmp_path / "arm"
    write_package(str(folder), FILES, "python", force=False)
    (folder / "arm/network.py").unlink()
    (folder / "arm/network.py").symlink_to(elsewhere / "network.py")
    with pytest.raises(UsageError, match="changed by hand"):
        write_package(str(folder), FILES, "python", force=False)
    write_package(str(folder), FILES, "python", force=True)
    assert contents(folder) == FILES
    assert not (folder / "arm/network.py").is_symlink()
    assert_untouched(elsewhere)


@pytest.mark.parametrize(
    "named", ["{elsewhere}/network.py", "../elsewhere/network.py", "arm/../../elsewhere/network.py", "a\\..\\b", ""]
)
def test_a_manifest_that_names_files_outside_is_not_trusted(tmp_path: Path, elsewhere: Path, named: str) -> None:
    folder = tmp_path / "arm"
    write_package(str(folder), FILES, "python", force=False)
    digest = sha256(b"of another program\n").hexdigest()
    with (folder / MANIFEST).open("a") as manifest:
        manifest.write(f"{digest}  {named.format(elsewhere=elsewhere)}\n")
    with pytest.raises(UsageError, match="was not written by cspdiag"):
        write_package(str(folder), FILES, "python", force=False)
    write_package(str(folder), FILES, "python", force=True)
    assert_untouched(elsewhere)


@pytest.mark.parametrize("make", ["link", "bytes"])
def test_an_invalid_manifest_is_not_trusted(tmp_path: Path, make: str) -> None:
    folder = tmp_path / "arm"
    write_package(str(folder), FILES, "python", force=False)
    manifest = folder / MANIFEST
    if make == "link":
        manifest.rename(tmp_path / "manifest")
        manifest.symlink_to(tmp_path / "manifest")
    else:
        manifest.write_bytes(b"\xff\xfe")
    with pytest.raises(UsageError, match="was not written by cspdiag"):
        write_package(str(folder), FILES, "python", force=False)
    write_package(str(folder), FILES, "python", force=True)
    write_package(str(folder), FILES, "python", force=False)


def test_a_new_folder_is_not_made_behind_a_link(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "new").symlink_to(tmp_path / "empty")
    with pytest.raises(UsageError, match="exists already"):
        write_new_folder(str(tmp_path / "new"), FILES)
    assert os.listdir(tmp_path / "empty") == []


def test_a_pipe_is_written_to_and_stays_one(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reading = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        replace_text(str(pipe), "text\n")
        assert os.read(reading, 100) == b"text\n"
    finally:
        os.close(reading)
    assert pipe.is_fifo()


def test_a_file_that_is_in_the_way_of_writing_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("secrets.token_hex", lambda _: "0123456789abcdef")
    other = tmp_path / "program.csp.0123456789abcdef.tmp"
    other.write_text("of another program\n")
    with pytest.raises(FileExistsError):
        replace_text(str(tmp_path / "program.csp"), "text\n")
    assert other.read_text() == "of another program\n"


@pytest.mark.parametrize("path", [MANIFEST, "README.md", "arm/network.py"])
def test_a_pipe_in_the_place_of_a_file_is_not_opened(tmp_path: Path, path: str) -> None:
    """A reader of the pipe would wait forever for a writer."""
    folder = tmp_path / "arm"
    write_package(str(folder), FILES, "python", force=False)
    (folder / path).unlink()
    os.mkfifo(folder / path)
    with pytest.raises(UsageError, match=f"{path}.*--force"):
        write_package(str(folder), FILES, "python", force=False)
    assert (folder / path).is_fifo()
    write_package(str(folder), FILES, "python", force=True)
    assert contents(folder) == FILES


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize(("obstacle", "is_folder"), [("README.md", True), (MANIFEST, True), ("arm", False)])
def test_obstacles_are_named_and_nothing_is_written(
    tmp_path: Path, obstacle: str, is_folder: bool, force: bool
) -> None:
    folder = tmp_path / "arm"
    folder.mkdir()
    if is_folder:
        (folder / obstacle).mkdir()
    else:
        (folder / obstacle).write_text("mine\n")
    with pytest.raises(UsageError) as refused:
        write_package(str(folder), FILES, "python", force=force)
    if force or obstacle != MANIFEST:
        assert str(refused.value).startswith(f"{folder / obstacle} is in the way: it is ")
    assert [path.name for path in folder.iterdir()] == [obstacle]
    assert [path.name for path in tmp_path.iterdir()] == ["arm"]


def test_a_failure_names_the_intended_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: str, text: str) -> None:
        raise OSError(28, "No space left on device", path)

    monkeypatch.setattr(output, "_write", full)
    for write in (
        lambda: write_package(str(tmp_path / "arm"), FILES, "python", force=False),
        lambda: write_new_folder(str(tmp_path / "arm"), FILES),
    ):
        with pytest.raises(OSError, match="No space left") as failed:
            write()
        assert failed.value.filename == str(tmp_path / "arm" / "README.md")
    assert not list(tmp_path.iterdir())


def test_a_pipe_without_a_reader_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "out.csv")
    with pytest.raises(OSError, match="it has no reader") as refused:
        replace_text(str(tmp_path / "out.csv"), "time\n")
    assert refused.value.filename == str(tmp_path / "out.csv")
