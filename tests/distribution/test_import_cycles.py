"""``make check`` refuses import cycles, of whatever kind the imports are."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CONFIGURATION = """
[tool.importlinter]
root_package = "package"
contract_types = ["no_cycles: distribution.import_cycles.NoCyclesContract"]

[[tool.importlinter.contracts]]
name = "No import cycles"
type = "no_cycles"
"""


def checked(folder: Path, **modules: str) -> subprocess.CompletedProcess[str]:
    (folder / "package").mkdir()
    (folder / "package" / "__init__.py").write_text("")
    for name, text in modules.items():
        (folder / "package" / f"{name}.py").write_text(text)
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


IMPORTS_BACK = {
    "at the top": "from package import lower\n",
    "for types": "from typing import TYPE_CHECKING\n\nif TYPE_CHECKING:\n    from package import lower\n",
    "inside a function": "def local_import() -> None:\n    from package import lower\n",
}


@pytest.mark.parametrize("back", IMPORTS_BACK.values(), ids=IMPORTS_BACK)
def test_a_cycle_is_refused_with_its_imports(tmp_path: Path, back: str) -> None:
    done = checked(tmp_path, upper="from package import middle\n", middle=back, lower="from package import upper\n")
    assert done.returncode == 1, done.stderr
    line = back[: back.index("from package")].count("\n") + 1
    assert "3 modules import each other:" in done.stdout
    assert f"- package.middle -> package.lower (l. {line})" in done.stdout


def test_a_module_that_imports_its_package_which_imports_it_is_a_cycle(tmp_path: Path) -> None:
    done = checked(
        tmp_path,
        __init__="from package.upper import constant\n",
        upper="from package import function\n\nconstant = 1\n",
    )
    assert done.returncode == 1, done.stderr
    assert "- package.upper -> package (l. 1)" in done.stdout


def test_imports_downwards_are_accepted(tmp_path: Path) -> None:
    done = checked(
        tmp_path, upper="from package import middle, lower\n", middle="from package import lower\n", lower=""
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_check_of_the_project_has_this_contract() -> None:
    assert 'type = "no_cycles"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")
