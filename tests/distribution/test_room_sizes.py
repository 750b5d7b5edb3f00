"""``make check`` refuses folders with more entries than one takes in at a glance."""

from __future__ import annotations

from pathlib import Path

from distribution.room_sizes import CROWDED, MOST, ROOT, complaints


def _room(root: Path, name: str, modules: int) -> None:
    (root / name).mkdir(parents=True)
    for number in range(modules):
        (root / name / f"module_{number}.py").touch()


def test_a_folder_with_too_many_modules_and_folders_is_named(tmp_path: Path) -> None:
    _room(tmp_path, "cspdiag/hall", MOST)
    assert complaints(tmp_path, {}) == []
    _room(tmp_path, "cspdiag/hall/closet", 1)
    (line,) = complaints(tmp_path, {})
    assert line.startswith(f"cspdiag/hall has {MOST + 1} entries")


def test_data_and_what_makes_a_package_do_not_count(tmp_path: Path) -> None:
    _room(tmp_path, "tests/hall", MOST)
    for name in ("__init__.py", "__main__.py", "program.csp", "programs/program.csp", "__pycache__/module.pyc"):
        (tmp_path / "tests/hall" / name).parent.mkdir(exist_ok=True)
        (tmp_path / "tests/hall" / name).touch()
    assert complaints(tmp_path, {}) == []


def test_an_exception_that_is_not_needed_is_refused(tmp_path: Path) -> None:
    _room(tmp_path, "cspdiag/hall", MOST + 1)
    _room(tmp_path, "cspdiag/closet", 1)
    lines = complaints(tmp_path, {"cspdiag/hall": "large", "cspdiag/closet": "small", "cspdiag/attic": "gone"})
    assert [line.partition(" ")[0] for line in lines] == ["cspdiag/closet", "cspdiag/attic"]


def test_the_rooms_of_this_house_are_in_order() -> None:
    assert complaints(ROOT, CROWDED) == []
