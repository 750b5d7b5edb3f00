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
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.draw.scene.shapes import Ink
from cspdiag.pipeline import check

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


PROPOSED = {
    "process": "submodel Law { in input : double out output : double output = input }",
    "environment": """process Process {
  in position : double
  out force : double
  communication { var x : double }
  composition { mu (position ? x ; force ! x) }
}
submodel Plant { in force : double out position : double position = force }""",
    "assertion": "process Process { composition { skip } }",
    "refinement": "process Process { composition { skip } } process Specification { composition { skip } }",
}
"""What the proposed texts of snippets name."""


@pytest.mark.parametrize("name", json.loads((FOLDER / "snippets" / "csp.json").read_text()))
def test_a_snippet_is_right_with_the_proposed_texts(name: str) -> None:
    text = filled(json.loads((FOLDER / "snippets" / "csp.json").read_text())[name]["body"])
    program = SourceFile(name="snippet.csp", text=f"{text}\n{PROPOSED.get(name, '')}")
    report = check(program, read_source).report
    assert [found.message for found in report.diagnostics if found.severity == "error"] == []


def matched(line: str) -> list[tuple[str, list[str]]]:
    """What the problem matchers take from a line, by the names of those that take it."""
    found: list[tuple[str, list[str]]] = []
    for pattern in manifest()["contributes"]["problemPatterns"]:
        match = re.search(pattern["regexp"], line)
        if match is not None:
            parts = ("file", "line", "column", "severity", "code", "message")
            found.append((pattern["name"], [match[pattern[part]] for part in parts]))
    return found


def test_the_problem_matchers_read_what_check_prints(tmp_path: Path) -> None:
    place = tmp_path / "my slip.csp"
    place.write_text("const period = 1 ms\nconst slow = 10 * peroid\n")
    for name, matcher in (("my slip.csp", "cspdiag"), (str(place), "cspdiag-absolute")):
        command = [sys.executable, "-m", "cspdiag", "check", "--format", "concise", name]
        printed = subprocess.run(command, cwd=tmp_path, stdout=PIPE, stderr=STDOUT, text=True).stdout
        values = [name, "2", "19", "error", "E0204", "there is no value `peroid`"]
        assert [found for line in printed.splitlines() for found in matched(line)] == [(matcher, values)]


def test_each_form_of_a_path_belongs_to_one_problem_matcher() -> None:
    forms = {
        "cspdiag": ["a.csp", "../b c/a.csp", r"lib\a.csp"],
        "cspdiag-absolute": ["/x/a.csp", r"C:\x\a.csp", "D:/x/a.csp"],
    }
    for matcher, names in forms.items():
        for name in names:
            assert [(by, parts[0]) for by, parts in matched(f"{name}:1:2: error[E0204] a: b")] == [(matcher, name)]


def test_no_problem_matcher_asks_for_files() -> None:
    """VS Code drops the problems of the last file if the task ends before a matcher knows where the file is."""
    matchers = manifest()["contributes"]["problemMatchers"]
    assert [each["fileLocation"] for each in matchers] == [["relative", "${workspaceFolder}"], "absolute"]


def test_problems_of_tasks_leave_those_of_the_server_alone() -> None:
    """Both are kept under one name, as the language client takes its own for that."""
    matchers = manifest()["contributes"]["problemMatchers"]
    assert {(each["owner"], each["applyTo"]) for each in matchers} == {("cspdiag", "closedDocuments")}


def test_a_snippet_is_filled_with_its_first_choice() -> None:
    assert filled("assert ${1:Name} ${2|terminates,deadlock free|} $1$0") == "assert Name terminates Name"
