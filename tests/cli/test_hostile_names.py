"""File names with line ends and escape sequences: for people, control pictures replace these on the line with the name;
machines get the name itself.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Command
from tests.cli.test_streams import PROGRAM

HOSTILE = "a\nZZZ\x1b[31m\x07.csp"
PICTURE = "a␊ZZZ␛[31m␇.csp"
WRONG = PROGRAM.replace("mu law", "mu lawx /* \x1b]0;title\x07 */")
FAULTY = PROGRAM.replace("y = 0 - x / 2", "y = x / (x - x)")
DEADLOCKED = PROGRAM.replace("mu law }", "(mu law) || c ! 1 }").replace("law : Law", "law : Law\n channel c : int")


COMMANDS = [
    ["check"],
    ["check", "--format", "concise"],
    ["compile", "-o", f"{HOSTILE}.out"],
    ["compile", "--emit", "ast"],
    ["compile", "--emit", "model"],
    ["compile", "--emit", "network"],
    ["verify", "--timing"],
    ["margins"],
    ["draw", "--diagram", "composition", "-o", f"{HOSTILE}.svg"],
    *(["draw", "--format", format_, "-o", "-"] for format_ in ("dot", "mermaid", "graphml")),
    ["fmt", "--check"],
    ["fmt"],
]
RUNS = [
    ["run", "--for", "20ms", "--record", f"{HOSTILE}.csv"],
    ["verify", "--no-cache", "--trace-out", f"{HOSTILE}.json"],
]


@pytest.mark.parametrize(
    ("command", "program"),
    [
        *((command, program) for command in COMMANDS for program in (PROGRAM, WRONG)),
        *((command, program) for command in RUNS for program in (PROGRAM, FAULTY, DEADLOCKED)),
    ],
)
def test_a_name_controls_no_terminal_and_ends_no_line(
    cspdiag: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: list[str], program: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path(HOSTILE).write_text(program)
    result = cspdiag(*command, HOSTILE)
    assert result.code < 3, result.err
    shown = result.out + result.err
    for line in shown.split("\n"):
        assert "".join(c for c in line if c.isprintable() or c == "\t") == line
        assert not line.lstrip().startswith("ZZZ"), shown


def test_a_missing_file_is_named_on_one_line(cspdiag: Command, tmp_path: Path) -> None:
    result = cspdiag("check", tmp_path / HOSTILE)
    assert result.err == f"cspdiag: {tmp_path / PICTURE}: no such file or directory\n"


def test_machines_get_the_name_as_it_is(cspdiag: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path(HOSTILE).write_text(WRONG)
    (found,) = json.loads(cspdiag("check", "--format", "json", HOSTILE).out)
    assert found["file"] == HOSTILE
    sarif = json.loads(cspdiag("check", "--format", "sarif", HOSTILE).out)
    place = sarif["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
    assert place == "a%0AZZZ%1B%5B31m%07.csp"
