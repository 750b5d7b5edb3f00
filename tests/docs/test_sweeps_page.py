"""``docs/sweeps.md``: its table is what the command prints, its command lines are understood, its example runs."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest

from cspdiag.cli.main import verb_parser
from cspdiag.sweep.measures import KINDS
from tests.cli.conftest import Command
from tests.cli.conftest import cspdiag as cspdiag  # a fixture

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "sweeps.md").read_text(encoding="utf-8")
SHELL = re.findall(r"^```sh\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
COMMANDS = [
    line
    for block in SHELL
    for line in block.replace("\\\n", " ").splitlines()
    if line.startswith("cspdiag sweep models")
]

needs_compiler = pytest.mark.skipif(
    not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler: install gcc or clang"
)


@needs_compiler
def test_the_first_table_is_what_is_printed(cspdiag: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    (table,) = re.findall(r"^```text\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    summary, _, rows = table.partition("\n")
    assert re.fullmatch(r"5 runs in .* s after .* s of compiling, as a native program: 5 terminated", summary)
    assert cspdiag(*shlex.split(COMMANDS[0])[1:]).out == rows


@pytest.mark.parametrize("command", COMMANDS)
def test_command_lines_are_understood(command: str) -> None:
    verb_parser("sweep").parse_args(shlex.split(command)[2:])


def test_every_measure_is_in_the_table() -> None:
    rows = re.findall(r"`(\w+)\(SIGNAL", PAGE)
    assert sorted(rows) == sorted(KINDS)


@needs_compiler
def test_the_example_in_python_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("matplotlib")
    (tmp_path / "models").symlink_to(ROOT / "models")
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    exec(compile(code, "sweeps.md", "exec"), {})
    assert capsys.readouterr().out.startswith("14 terminated\n")
    assert (tmp_path / "gains.svg").exists()
