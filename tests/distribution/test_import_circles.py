"""``make check`` refuses circles of imports, of whatever kind the imports are."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CONFIGURATION = """
[tool.importlinter]
root_package = "house"
contract_types = ["no_circles: distribution.import_circles.NoCirclesContract"]

[[tool.importlinter.contracts]]
name = "No module imports itself by way of others"
type = "no_circles"
"""


def checked(folder: Path, **modules: str) -> subprocess.CompletedProcess[str]:
    (folder / "house").mkdir()
    (folder / "house" / "__init__.py").write_text("")
    for name, text in modules.items():
        (folder / "house" / f"{name}.py").write_text(text)
    (folder / "pyproject.toml").write_text(CONFIGURATION)
    lint = "import sys; from importlinter.cli import lint_imports_command; lint_imports_command()"
    return subprocess.run(
        [sys.executable, "-c", lint, "--no-cache"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200"},
        capture_output=True,
        text=True,
        check=False,
    )


BEHIND = {
    "at the top": "from house import cellar\n",
    "for types": "from typing import TYPE_CHECKING\n\nif TYPE_CHECKING:\n    from house import cellar\n",
    "inside a function": "def look() -> None:\n    from house import cellar\n",
}


@pytest.mark.parametrize("back", BEHIND.values(), ids=BEHIND)
def test_a_circle_is_refused_with_its_imports(tmp_path: Path, back: str) -> None:
    done = checked(tmp_path, attic="from house import stairs\n", stairs=back, cellar="from house import attic\n")
    assert done.returncode == 1, done.stderr
    line = back[: back.index("from house")].count("\n") + 1
    assert "3 modules import each other in a circle:" in done.stdout
    assert f"- house.stairs -> house.cellar (l. {line})" in done.stdout


def test_a_module_that_imports_its_package_which_imports_it_is_a_circle(tmp_path: Path) -> None:
    done = checked(tmp_path, __init__="from house.attic import key\n", attic="from house import door\n\nkey = 1\n")
    assert done.returncode == 1, done.stderr
    assert "- house.attic -> house (l. 1)" in done.stdout


def test_imports_downwards_are_accepted(tmp_path: Path) -> None:
    done = checked(tmp_path, attic="from house import stairs, cellar\n", stairs="from house import cellar\n", cellar="")
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_check_of_the_project_has_this_contract() -> None:
    assert 'type = "no_circles"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")
