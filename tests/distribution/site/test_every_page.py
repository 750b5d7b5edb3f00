"""What holds for every page: programs are right, and commands can be typed as they are shown."""

from __future__ import annotations

import re
import shlex
from contextlib import redirect_stderr
from io import StringIO
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.cli.main import VERBS, verb_parser

ROOT = Path(__file__).parents[3]
PAGES = [
    ROOT / "README.md",
    *sorted(page for page in (ROOT / "docs").rglob("*.md") if page.name != "diagnostics.md"),
    *sorted((ROOT / "models").glob("*/README.md")),
]
_FENCE = re.compile(r"^(?:<!-- (\S+) -->\n)?```csp(?: (\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_FENCED = re.compile(r"^```(?:sh|console)?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_INDENTED = re.compile(r"^(?: {4}(?:\$ )?)(cspdiag [^\n]*)$", re.MULTILINE)

NOT_WHOLE = {
    ("README.md", "  communication {"): "an excerpt of JIWY",
    ("docs/fmi.md", 'import "tank.csp"'): "the program above, with an FMU that is made from it",
    ("docs/notation.md", "process Joint {"): "its instances belong to no definition",
    ("docs/tutorial.md", 'import "axis.csp"'): "the program above, with an FMU",
    ("models/jiwy/README.md", "composition {"): "an excerpt of JIWY",
}
"""Blocks that are not programs by themselves, by their page and how they begin."""


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def commands(page: Path) -> list[str]:
    """The command lines of a page that begin with cspdiag, without comments and what a shell adds."""
    text = page.read_text(encoding="utf-8")
    lines = [line for block in _FENCED.findall(text) for line in block.replace("\\\n", " ").splitlines()]
    lines += _INDENTED.findall(text)
    given = [line.removeprefix("$ ").strip() for line in lines]
    return [line for line in given if line.startswith("cspdiag ")]


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_programs_are_right(page: Path) -> None:
    def read(path: str) -> SourceFile:
        file = ROOT / path
        return SourceFile(name=path, text=file.read_text(encoding="utf-8"))

    found = []
    for mark, name, program in _FENCE.findall(page.read_text(encoding="utf-8")):
        if name.startswith("broken/") or mark == "half.csp":
            continue
        if any(of == name_of(page) and program.startswith(begins) for of, begins in NOT_WHOLE):
            continue
        source = SourceFile(name=mark if "/" in mark else "program.csp", text=program)
        errors = [each for each in pipeline.check(source, read).report.diagnostics if each.severity == "error"]
        found += [f"{each.span.line}: {each.code} {each.message}" for each in errors]
    assert found == []


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_commands_are_understood(page: Path) -> None:
    wrong = []
    for command in commands(page):
        line = re.split(r" (?:\||&&|;|>|2>|<|&) ?", command)[0]
        words = shlex.split(line, comments=True)[1:]
        if not words or words[0].startswith("-") or words[0].isupper():
            continue
        if words[0] not in VERBS:
            wrong.append(command)
            continue
        said = StringIO()
        try:
            with redirect_stderr(said):
                verb_parser(words[0]).parse_args(words[1:])
        except SystemExit as ended:
            if not ended.code:
                continue
            wrong.append(f"{command}: {said.getvalue()}")
    assert wrong == []
