"""Every program in the documentation compiles, and every fragment can be parsed."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import Report, SourceFile
from cspdiag.base.sources import read_source
from cspdiag.simulate.native import run as native
from cspdiag.syntax import ast
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse

ROOT = Path(__file__).parents[2]
needs_compiler = pytest.mark.skipif(
    not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler: install gcc or clang"
)
LANGUAGE = ROOT / "docs" / "language.md"
_FENCE = re.compile(r"^```(?P<kind>csp|csp-fragment)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(kind: str) -> list[object]:
    text = LANGUAGE.read_text(encoding="utf-8")
    return [
        pytest.param(match["text"], id=f"line {text.count(chr(10), 0, match.start()) + 1}")
        for match in _FENCE.finditer(text)
        if match["kind"] == kind
    ]


def no_other_file(path: str) -> SourceFile:
    raise OSError(path)


@pytest.mark.parametrize("text", blocks("csp"))
def test_programs_compile(text: str) -> None:
    checked = pipeline.check(SourceFile(name="language.md", text=text), no_other_file)
    assert [f"{d.span.line}: {d.code} {d.message}" for d in checked.report.diagnostics] == []


@pytest.mark.parametrize("text", blocks("csp") + blocks("csp-fragment"))
def test_examples_are_in_the_standard_format(text: str) -> None:
    report = Report()
    tree = parse(SourceFile(name="language.md", text=text), report)
    assert [f"{d.span.line}: {d.code} {d.message}" for d in report.diagnostics] == []
    assert ast.same_tree(tree, parse(SourceFile(name="language.md", text=format_tree(tree)), report))
    assert format_tree(tree) == text


def test_reserved_words_are_listed() -> None:
    text = LANGUAGE.read_text(encoding="utf-8")
    reserved, _, rest = text.partition("These words are reserved")[2].partition("These are words where")
    of_their_place = rest.partition("So a port may be called")[0]
    from cspdiag.syntax.parse.lexer import CONTEXTUAL_KEYWORDS
    from cspdiag.syntax.parse.tables import load

    words = {word for word in load().words if word[0].isalpha()}
    assert set(re.findall(r"`(\w+)`", of_their_place)) == CONTEXTUAL_KEYWORDS
    assert set(re.findall(r"`(\w+)`", reserved)) == words - CONTEXTUAL_KEYWORDS


def _with_the_files_of_the_page_about_c(folder: Path) -> str:
    text = (ROOT / "docs" / "c.md").read_text(encoding="utf-8")
    for name, body in re.findall(r"^<!-- (\S+) -->\n```\w+\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        (folder / name).write_text(body)
    return text


@needs_compiler
def test_the_driver_in_c_runs(tmp_path: Path) -> None:
    text = _with_the_files_of_the_page_about_c(tmp_path)
    commands = re.findall(r"^    (.*heater.*?)(?: +#.*)?$", text.partition("### Drivers in the text")[2], re.MULTILINE)
    for command in [f"{commands[0]} --for 20ms", *commands[1:3], commands[3].replace("1000000000", "20000000")]:
        words = command.split()
        if words[0] == "cspdiag":
            words[:1] = [sys.executable, "-m", "cspdiag"]
        completed = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
        assert completed.returncode == 0, f"{command}: {completed.stdout}{completed.stderr}"
    assert "reached the time limit" in completed.stderr


@needs_compiler
def test_the_control_law_in_c_runs(tmp_path: Path) -> None:
    _with_the_files_of_the_page_about_c(tmp_path)
    network = pipeline.build(read_source(str(tmp_path / "tank.csp")), read_source).network
    assert network is not None
    run = native.simulate(network, read_source, until=20_000_000_000)
    assert run["level"][-1] == pytest.approx(1.25, abs=1e-3)
