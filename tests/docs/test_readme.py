"""What the README shows is what the tool does."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.render.text import render
from cspdiag.base.sources import read_source
from cspdiag.cli.main import VERBS, main, verb_parser
from cspdiag.draw.layout.elk import engine_available

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()
JIWY = ROOT / "models/jiwy/jiwy.csp"


def test_the_excerpt_is_in_the_model() -> None:
    (excerpt,) = re.findall(r"```csp\n(.*?)```", README, re.DOTALL)
    lines = {line.strip() for line in JIWY.read_text().splitlines()}
    assert [line for line in excerpt.splitlines() if line.strip() not in lines] == []


def test_the_diagnostic_is_what_the_compiler_says(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    text = JIWY.read_text().replace("-> broadcast ->", "->", 1)
    source = SourceFile(name="models/jiwy/jiwy.csp", text=text)
    (diagnostic,) = pipeline.check(source, read_source).report.diagnostics
    shown = render([diagnostic]).removesuffix("\n1 error\n")
    assert f"```\n{shown}```" in README
    assert f"cspdiag explain {diagnostic.code}" in README


def test_the_command_lines_are_understood() -> None:
    commands = re.findall(r"^    cspdiag ([^#\n]+)", README, re.MULTILINE)
    assert len(commands) > 5
    for command in commands:
        verb, *arguments = shlex.split(command)
        assert verb in VERBS
        verb_parser(verb).parse_args(arguments)


@pytest.mark.skipif(shutil.which("git") is None or shutil.which("cc") is None, reason="needs git and a C compiler")
@pytest.mark.skipif(not engine_available(), reason="the layout engine was not fetched (make setup)")
def test_the_tour_ends_well_in_a_fresh_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for variable in ("GIT_AUTHOR_NAME", "GIT_AUTHOR_EMAIL", "GIT_COMMITTER_NAME", "GIT_COMMITTER_EMAIL"):
        monkeypatch.setenv(variable, "reader")
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    (tour,) = re.findall(r"^## A tour\n\n((?:    .*\n)+)", README, re.MULTILINE)
    for line in tour.splitlines():
        for command in line.partition(" # ")[0].split("&&"):
            program, *arguments = shlex.split(command)
            ended = main(arguments) if program == "cspdiag" else subprocess.run([program, *arguments]).returncode
            assert (ended, command) == (0, command)
    assert (tmp_path / "changes.svg").stat().st_size > 0


def test_the_files_it_points_to_exist() -> None:
    targets = [target for target in re.findall(r"\]\(([^)]+)\)", README) if "://" not in target]
    assert targets
    assert [target for target in targets if not (ROOT / target).exists()] == []
