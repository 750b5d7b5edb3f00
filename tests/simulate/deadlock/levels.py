"""Runs a program that deadlocks wherever programs run, and reads what is reported."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag.cli.main import main

LEVELS = [["-O0"], ["-O1"], ["--target", "c", "-O0"], ["--target", "c", "-O1"], ["-O", "reference"]]


def report(text: str, arguments: list[str], folder: Path, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """The lines of the report of a run of ``Main``, in the file ``case.csp``."""
    (folder / "case.csp").write_text(f"{text}environment E for Main {{ }}\n")
    assert main(["run", str(folder / "case.csp"), *arguments, "--quiet"]) == 1
    shown = capsys.readouterr().err.splitlines()
    return shown[next(index for index, line in enumerate(shown) if line.startswith("deadlock")) :]
