"""Generated packages in C as real files in ``tests/golden``; ``--update-golden`` rewrites them."""

from __future__ import annotations

import re
import shutil

import pytest

from cspdiag import pipeline
from tests.codegen.packages import network, read
from tests.codegen.test_golden import GOLDEN, stored

BUILD = re.compile(r"(?<=static const uint32_t build = UINT32_C\(0x)[0-9a-f]{8}")
"""The identity of a build, which changes with the kernel."""


@pytest.mark.parametrize(("name", "level"), [("commstime", 0), ("emergency", 0), ("jiwy", 0), ("jiwy", 1)])
def test_packages_are_as_they_were_read(name: str, level: int, pytestconfig: pytest.Config) -> None:
    """All files except the kernel, which is the same for every program."""
    folder = GOLDEN / name / ("c" if level == 0 else "c-O1")
    package = pipeline.generate(network(name), read, "c", level)
    files = {path: BUILD.sub("0" * 8, text) for path, text in package.items() if not path.startswith("support/")}
    if pytestconfig.getoption("--update-golden"):
        shutil.rmtree(folder, ignore_errors=True)
        for path, text in files.items():
            target = folder / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
    assert files == stored(folder)
