"""``make check`` refuses folders with more entries than a reader can take in at a glance."""

from __future__ import annotations

from pathlib import Path

from distribution.folder_sizes import EXCEPTIONS, MAX_ENTRIES, ROOT, complaints


def _make_folder(root: Path, name: str, modules: int) -> None:
    (root / name).mkdir(parents=True)
    for number in range(modules):
        (root / name / f"module_{number}.py").touch()


def test_a_folder_with_too_many_modules_and_folders_is_named(tmp_path: Path) -> None:
    _make_folder(tmp_path, "cspdiag/large", MAX_ENTRIES)
    assert complaints(tmp_path, {}) == []
    _make_folder(tmp_path, "cspdiag/large/small", 1)
    (line,) = complaints(tmp_path, {})
    assert line.startswith(f"cspdiag/large has {MAX_ENTRIES + 1} entries")


def test_data_and_package_markers_do_not_count(tmp_path: Path) -> None:
    _make_folder(tmp_path, "tests/large", MAX_ENTRIES)
    for name in ("__init__.py", "__main__.py", "program.csp", "programs/program.csp", "__pycache__/module.pyc"):
        (tmp_path / "tests/large" / name).parent.mkdir(exist_ok=True)
        (tmp_path / "tests/large" / name).touch()
    assert complaints(tmp_path, {}) == []


def test_an_exception_that_is_not_needed_is_refused(tmp_path: Path) -> None:
    _make_folder(tmp_path, "cspdiag/large", MAX_ENTRIES + 1)
    _make_folder(tmp_path, "cspdiag/small", 1)
    lines = complaints(tmp_path, {"cspdiag/large": "large", "cspdiag/small": "small", "cspdiag/missing": "gone"})
    assert [line.partition(" ")[0] for line in lines] == ["cspdiag/small", "cspdiag/missing"]


def test_the_folders_of_the_project_are_small_enough() -> None:
    assert complaints(ROOT, EXCEPTIONS) == []
