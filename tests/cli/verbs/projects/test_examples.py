"""The examples that ship, copied and begun from."""

from __future__ import annotations

import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Command

ROOT = Path(__file__).parents[4]
EXAMPLES = sorted(path.name for path in (ROOT / "models").iterdir() if (path / "README.md").exists())


def test_each_is_listed_with_what_it_is_about(cspdiag: Command) -> None:
    lines = cspdiag("examples").out.splitlines()
    assert [line.split()[0] for line in lines] == EXAMPLES
    assert "dining       Five philosophers share five forks; each needs two to eat" in lines


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_copy_has_no_errors(cspdiag: Command, tmp_path: Path, name: str) -> None:
    folder = tmp_path / "some folder"
    result = cspdiag("examples", name, "-o", folder)
    assert result.code == 0
    programs = list(folder.rglob("*.csp"))
    assert programs
    assert cspdiag("check", *programs).code == 0
    for page in folder.rglob("README.md"):
        assert "](../../docs/pictures" not in page.read_text()
    run = shlex.split(result.err.splitlines()[-1])
    assert run[:-1] == ["try:", "cspdiag", "run"]
    assert Path(run[-1]).is_file()


def test_what_exists_is_not_touched(cspdiag: Command, tmp_path: Path) -> None:
    (tmp_path / "jiwy").mkdir()
    mine = tmp_path / "jiwy" / "mine.csp"
    mine.write_text("mine")
    result = cspdiag("examples", "jiwy_mujoco", "-o", tmp_path)
    assert (result.code, "jiwy exists already" in result.err) == (2, True)
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["jiwy", "mine.csp"]


def test_a_wrong_name_gives_the_nearest(cspdiag: Command) -> None:
    result = cspdiag("examples", "jiwi")
    assert (result.code, result.err) == (2, "cspdiag: there is no example 'jiwi' (did you mean jiwy?)\n")


@pytest.mark.parametrize("example", ["dining", "watchdog"])
def test_the_tests_of_a_project_begun_from_an_example_pass(
    cspdiag: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, example: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cspdiag("new", "mine", "--from", example).code == 0
    for path in (tmp_path / "mine").rglob("*"):
        assert path.is_dir() or "_NAME" not in path.read_text()
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"],
        cwd=tmp_path / "mine", env={"PYTHONPATH": str(ROOT), "PATH": ""}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert "2 passed" in done.stdout, done.stdout + done.stderr


def test_an_example_of_two_folders_is_not_a_project(cspdiag: Command, tmp_path: Path) -> None:
    result = cspdiag("new", tmp_path / "mine", "--from", "jiwy_mujoco")
    assert result.code == 2
    assert "copy both with cspdiag examples jiwy_mujoco" in result.err
    assert not list(tmp_path.iterdir())
