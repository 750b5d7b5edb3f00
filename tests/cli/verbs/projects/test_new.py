from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Command


@pytest.mark.parametrize("name", ["gimbal", "two-axis_arm", "Motor", "process"])
def test_a_new_project_is_clean_and_formatted(
    cspdiag: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cspdiag("new", name).code == 0
    (program,) = (tmp_path / name).glob("*.csp")
    assert cspdiag("check", program).code == 0
    assert cspdiag("fmt", "--check", program).code == 0
    assert cspdiag("verify", "--no-cache", program).code == 0
    for path in (tmp_path / name).rglob("*"):
        assert "_NAME" not in path.name
        assert path.is_dir() or "_NAME" not in path.read_text()


def test_the_tests_of_a_new_project_pass(cspdiag: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert cspdiag("new", "gimbal").code == 0
    result = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"],
        cwd=tmp_path / "gimbal",
        env={"PYTHONPATH": str(Path(__file__).parents[4]), "PATH": ""},
        capture_output=True,
        text=True,
    )
    assert result.returncode == 0, result.stdout + result.stderr
    assert "2 passed" in result.stdout


def test_nothing_that_exists_is_touched(cspdiag: Command, tmp_path: Path) -> None:
    mine = tmp_path / "gimbal" / "notes.txt"
    mine.parent.mkdir()
    mine.write_text("mine")
    result = cspdiag("new", mine.parent)
    assert result.code == 2
    assert "exists already" in result.err
    assert [path.name for path in tmp_path.rglob("*")] == ["gimbal", "notes.txt"]
    mine.unlink()
    assert cspdiag("new", mine.parent).code == 0


def test_a_word_of_python_is_refused_as_such(cspdiag: Command) -> None:
    result = cspdiag("new", "class")
    assert result.code == 2
    assert "'class' cannot name a project: it is a keyword of Python" in result.err
    result = cspdiag("new", "Math")
    assert result.code == 2
    assert "'Math' cannot name a project: it is a module of Python's library" in result.err
