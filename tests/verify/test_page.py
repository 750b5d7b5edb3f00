"""docs/verification.md shows what the tool prints."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cspdiag.cli.main import VERBS, verb_parser
from tests.cli.conftest import Command, cspdiag  # noqa: F401 - a fixture

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "verification.md").read_text(encoding="utf-8")


def _comparable(text: str) -> list[str]:
    """The lines without times and numbers of states, which may change."""
    lines = [re.sub(r"  \(.*\)$|in \d+\.\d+ s$", "", line) for line in text.splitlines()]
    return [line for line in lines if line]


@pytest.fixture(autouse=True)
def at_the_root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    (tmp_path / "crossing.csp").write_text(re.findall(r"```csp\n(.*?)```", PAGE, re.DOTALL)[0])
    monkeypatch.chdir(ROOT)


@pytest.mark.parametrize("file", ["crossing.csp", "models/jiwy/stolen_button.csp"])
def test_the_reports_are_those_of_the_command(
    file: str,
    cspdiag: Command,  # noqa: F811
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (shown,) = re.findall(rf"^\$ cspdiag verify {re.escape(file)}\n(.*?)```", PAGE, re.DOTALL | re.MULTILINE)
    if not (ROOT / file).exists():
        monkeypatch.chdir(tmp_path)
    reported = _comparable(cspdiag("verify", file).err)
    begins, *others = shown.split("\n...\n")  # Between them the page leaves lines out.
    assert reported[: len(_comparable(begins))] == _comparable(begins)
    for other in others:
        lines = _comparable(other)
        assert any(reported[start : start + len(lines)] == lines for start in range(len(reported))), other


def test_the_command_lines_are_understood() -> None:
    commands = re.findall(r"^    cspdiag (.+)$", PAGE, re.MULTILINE)
    assert len(commands) > 5
    for command in commands:
        verb, *arguments = command.split()
        assert verb in VERBS
        verb_parser(verb).parse_args(arguments)
