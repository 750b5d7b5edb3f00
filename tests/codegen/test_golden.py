"""Generated packages as real files in ``tests/golden``; ``--update-golden`` rewrites them."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.codegen.packages import MODELS, ROOT, written_by_generator

GOLDEN = ROOT / "tests" / "golden"


def stored(folder: Path) -> dict[str, str]:
    files = (path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return {str(path.relative_to(folder)): path.read_text(encoding="utf-8") for path in files}


@pytest.mark.parametrize("name", MODELS)
def test_packages_are_as_they_were_read(name: str, pytestconfig: pytest.Config) -> None:
    folder = GOLDEN / name / "python"
    files = written_by_generator(name)
    if pytestconfig.getoption("--update-golden"):
        shutil.rmtree(folder, ignore_errors=True)
        for path, text in files.items():
            target = folder / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
    assert files == stored(folder)
