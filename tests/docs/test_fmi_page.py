"""What docs/fmi.md shows works as it is shown."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from cspdiag.cli.main import main

PAGE = (Path(__file__).parents[2] / "docs" / "fmi.md").read_text(encoding="utf-8")


def block(language: str, containing: str) -> str:
    """The block of code with this text."""
    found = re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    return next(text for text in found if containing in text)


def test_the_tank_is_exported_and_simulated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("fmpy")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CFLAGS", "-O0")
    (tmp_path / "tank.csp").write_text(block("csp", "process Tank"))
    commands = [
        shlex.split(line, comments=True)
        for line in re.findall(r"^    ((?:cspdiag (?:compile|run)|fmpy) .*)$", PAGE, re.M)
    ]
    assert [command[0] for command in commands[:4]] == ["cspdiag", "cspdiag", "fmpy", "fmpy"]
    for command in commands[:4]:
        if command[0] == "cspdiag":
            assert main(command[1:]) == 0
        else:
            done = subprocess.run(
                [sys.executable, "-m", "fmpy", *command[1:]], capture_output=True, text=True, check=False
            )
            assert done.returncode == 0, done.stderr
            assert command[1] != "validate" or done.stdout == "No problems found.\n"
    assert (tmp_path / "tank.csv").read_text().startswith('"time","opening"')
    (tmp_path / "loop.py").write_text(block("python", "fmpy.extract"))
    done = subprocess.run([sys.executable, "loop.py"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("[1.")
    (tmp_path / "loop.csp").write_text(block("csp", "AsFmu"))
    runs = [command for command in commands[4:] if command[1] == "run"]
    assert len(runs) == 2
    for command in runs:
        assert main(command[1:]) == 0
