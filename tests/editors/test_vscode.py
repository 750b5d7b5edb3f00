"""The extension for VS Code: its own tests, and what it has to know of the language and of the commands."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from subprocess import PIPE, STDOUT
from typing import Any

import pytest

import cspdiag
from cspdiag.base.report import Report
from cspdiag.base.span import SourceFile
from cspdiag.draw.scene.shapes import Ink
from cspdiag.syntax.on_demand import parsed

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "editors" / "vscode"
END_TO_END = FOLDER / "test" / "e2e"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")

has_packages = pytest.mark.skipif(
    shutil.which("npm") is None or not (FOLDER / "node_modules").is_dir(),
    reason="editors/vscode/node_modules is not there: `make vscode` installs it with npm",
)
has_editor = pytest.mark.skipif(
    not (END_TO_END / "node_modules").is_dir() or CHROMIUM is None,
    reason="code-server or chromium is not there: `make test-vscode` installs the first with npm",
)


def manifest() -> dict[str, Any]:
    found: dict[str, Any] = json.loads((FOLDER / "package.json").read_text())
    return found


def npm(*arguments: str, **environment: str) -> None:
    done = subprocess.run(
        ["npm", "run", "--silent", *arguments], cwd=FOLDER, capture_output=True, text=True, env=os.environ | environment
    )
    assert done.returncode == 0, done.stdout + done.stderr


@has_packages
@pytest.mark.parametrize("script", ["test:grammar", "test:unit"])
def test_its_own_tests_pass(script: str) -> None:
    npm(script)


@has_packages
@has_editor
@pytest.mark.slow
def test_it_works_in_an_editor() -> None:
    """Packs the extension, installs it in code-server and uses it in a browser."""
    npm("package")
    npm("test:e2e", CSPDIAG=str(Path(sys.executable).parent / "cspdiag"), CHROMIUM=str(CHROMIUM))


def test_its_version_is_that_of_cspdiag() -> None:
    assert manifest()["version"] == cspdiag.__version__


def test_it_highlights_every_keyword() -> None:
    keywords = set(re.findall(r'"([a-z]+)"', (ROOT / "grammars" / "csp.lark").read_text()))
    grammar = json.loads((FOLDER / "syntaxes" / "csp.tmLanguage.json").read_text())
    patterns = [each["match"] for part in ("keyword", "constant") for each in grammar["repository"][part]["patterns"]]
    unknown = {word for word in keywords if not any(re.fullmatch(pattern, word) for pattern in patterns)}
    assert unknown == set()


def test_the_page_of_the_diagram_knows_every_colour() -> None:
    page, diagram = ((FOLDER / "src" / "webview" / name).read_text() for name in ("page.css", "diagram.css"))
    for ink in Ink:
        assert f".fill-{ink.value} {{\n  fill: var(--{ink.value});" in diagram
        assert f".stroke-{ink.value} {{\n  stroke: var(--{ink.value});" in diagram
        assert f"\n  --{ink.value}: " in page


def filled(body: str | list[str]) -> str:
    """A snippet with the proposed texts in its places."""
    text = body if isinstance(body, str) else "\n".join(body)
    proposed: dict[str, str] = {}
    for number, choice, default in re.findall(r"\$\{(\d+)(?:\|([^|,]*)[^|]*\||:([^}]*))\}", text):
        proposed.setdefault(number, choice or default)
    text = re.sub(r"\$\{(\d+)[^}]*\}", lambda place: proposed[place[1]], text)
    return re.sub(r"\$(\d+)", lambda place: proposed.get(place[1], ""), text)


@pytest.mark.parametrize("name", json.loads((FOLDER / "snippets" / "csp.json").read_text()))
def test_a_snippet_is_a_program_with_the_proposed_texts(name: str) -> None:
    text = filled(json.loads((FOLDER / "snippets" / "csp.json").read_text())[name]["body"])
    report = Report()
    parsed(SourceFile(name="snippet.csp", text=text), report)
    assert [found.message for found in report.diagnostics] == []


def test_the_problem_matcher_reads_what_check_prints(tmp_path: Path) -> None:
    (tmp_path / "my slip.csp").write_text("const period = 1 ms\nconst slow = 10 * peroid\n")
    command = [sys.executable, "-m", "cspdiag", "check", "--format", "concise", "my slip.csp"]
    printed = subprocess.run(command, cwd=tmp_path, stdout=PIPE, stderr=STDOUT, text=True).stdout
    (pattern,) = manifest()["contributes"]["problemPatterns"]
    found = re.search(pattern["regexp"], printed, re.MULTILINE)
    assert found is not None, printed
    parts = [found[pattern[part]] for part in ("file", "line", "column", "severity", "code", "message")]
    assert parts == ["my slip.csp", "2", "19", "error", "E0204", "there is no value `peroid`"]


def test_a_snippet_is_filled_with_its_first_choice() -> None:
    assert filled("assert ${1:Name} ${2|terminates,deadlock free|} $1$0") == "assert Name terminates Name"
