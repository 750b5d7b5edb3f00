"""Generated packages pass the linter, the formatter and the type checker with their own settings."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.codegen.packages import NAMES, ROOT, network, written_by_generator

RUNTIME = '"""In place of the copied runtime, which is checked in its own folder."""\n\nfrom cspdiag.runtime import *\n'
COMMAND_LINE = (
    "from cspdiag.runtime.command_line import Program as Program\nfrom cspdiag.runtime.command_line import main as "
    "main\n"
)


@pytest.fixture(scope="module", params=[0, 1], ids=["O0", "O1"])
def workspace(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    folder = tmp_path_factory.mktemp("packages")
    for name in NAMES:
        files = written_by_generator(name, request.param)
        package = next(path.partition("/")[0] for path in files if path.endswith("/__init__.py"))
        files[f"{package}/runtime/__init__.py"] = RUNTIME
        files[f"{package}/runtime/command_line.py"] = COMMAND_LINE
        for path, text in files.items():
            target = folder / name / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
    return folder


def run(*command: str, folder: Path, **environment: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", *command],
        cwd=folder,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_linter_is_content(workspace: Path) -> None:
    run("ruff", "check", "--no-cache", ".", folder=workspace)


def test_the_formatter_changes_nothing(workspace: Path) -> None:
    run("ruff", "format", "--no-cache", "--diff", ".", folder=workspace)


def test_the_type_checker_is_content(workspace: Path, pytestconfig: pytest.Config) -> None:
    packages = [argument for name in NAMES for argument in ("-p", network(name).name)]
    places = os.pathsep.join([str(ROOT), *(str(workspace / name) for name in NAMES)])
    cache = str(pytestconfig.cache.mkdir("mypy-of-generated")) if pytestconfig.cache else os.devnull
    run("mypy", "--strict", "--cache-dir", cache, *packages, folder=workspace, MYPYPATH=places)
