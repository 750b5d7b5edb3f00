"""The record of deviations from MISRA C:2012 has all that cppcheck finds in generated code and the kernel's headers."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def test_rules_that_are_not_in_the_record_have_no_findings() -> None:
    if shutil.which("cppcheck") is None:
        pytest.skip("not installed: cppcheck")
    command = [sys.executable, ROOT / "distribution" / "misra.py", "--quick"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=200)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "  15.5 " in done.stdout


def test_the_counts_of_the_record_are_compared_for_each_change() -> None:
    workflow = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
    assert "      - run: python distribution/misra.py\n" in workflow
