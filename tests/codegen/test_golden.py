"""Generated packages as real files in ``tests/golden``; ``--update-golden`` rewrites them."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.codegen.packages import MODELS, ROOT, written_by_generator

GOLDEN = ROOT / "tests" / "golden"


def stored(folder: Path) -> dict[str, str]:
    """The committed files, without what linters and the interpreter leave next to them."""
    files = {str(path.relative_to(folder)): path for path in folder.rglob("*") if path.is_file()}
    return {
        name: path.read_text(encoding="utf-8")
        for name, path in files.items()
        if "__pycache__" not in name and not any(part.startswith(".") for part in Path(name).parts)
    }


FAST = ("commstime", "jiwy", "watchdog")
"""Optimized packages that are kept: a fused program, control laws in modes, alternatives with time-outs."""


@pytest.mark.parametrize(("name", "level"), [*((name, 0) for name in MODELS), *((name, 1) for name in FAST)])
def test_packages_are_as_they_were_read(name: str, level: int, pytestconfig: pytest.Config) -> None:
    folder = GOLDEN / name / ("python" if level == 0 else "python-O1")
    files = written_by_generator(name, level)
    if pytestconfig.getoption("--update-golden"):
        shutil.rmtree(folder, ignore_errors=True)
        for path, text in files.items():
            target = folder / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
    assert files == stored(folder)
