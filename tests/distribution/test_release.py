"""The parts of a release agree: the version, the changelog, the page about releasing, continuous integration, the
forms.
"""

from __future__ import annotations

import os
import re
import shlex
import tomllib
from pathlib import Path

import pytest

import cspdiag
from cspdiag.cli.main import VERBS, verb_parser

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
RELEASING = (ROOT / "docs" / "releasing.md").read_text(encoding="utf-8")
WORKFLOW = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
FORMS = [path for path in sorted((ROOT / ".github/ISSUE_TEMPLATE").glob("*.yml")) if path.name != "config.yml"]


def test_the_version_is_the_same_everywhere() -> None:
    assert PROJECT["version"] == cspdiag.__version__
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.findall(r"^## (\S+)", changelog, re.MULTILINE)[0] == cspdiag.__version__


def test_continuous_integration_runs_what_is_run_here_on_the_versions_that_are_promised() -> None:
    assert os.access(ROOT / ".ci" / "run", os.X_OK)
    assert "- run: .ci/run\n" in WORKFLOW
    (matrix,) = re.findall(r"^ +python: \[(.*)\]$", WORKFLOW, re.MULTILINE)
    versions = [version.strip('" ') for version in matrix.split(",")]
    assert f">={versions[0]}" == PROJECT["requires-python"]
    promised = [kind.rpartition(" ")[2] for kind in PROJECT["classifiers"] if re.search(r"Python :: 3\.\d", kind)]
    assert set(versions) <= set(promised)


def test_the_command_lines_are_understood() -> None:
    commands = re.findall(r"(?:^ +- run: |&& (?:\S*/)?)cspdiag ([^&\n]+)", WORKFLOW + RELEASING, re.MULTILINE)
    assert len(commands) == 4
    for command in commands:
        verb, *arguments = shlex.split(command)
        assert verb in VERBS
        verb_parser(verb).parse_args(arguments)


def test_the_targets_of_make_exist() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = {
        target for line in re.findall(r"^    make ([a-z ]+)", RELEASING, re.MULTILINE) for target in line.split()
    }
    assert {"check", "test", "hunt", "pictures"} <= targets
    assert [target for target in targets if not re.search(rf"^{target}:", makefile, re.MULTILINE)] == []


@pytest.mark.parametrize("form", FORMS, ids=lambda path: path.stem)
def test_a_form_has_what_github_requires(form: Path) -> None:
    text = form.read_text(encoding="utf-8")
    assert re.findall(r"^(\w+):", text, re.MULTILINE) == ["name", "description", "labels", "body"]
    fields = text.split("  - type: ")[1:]
    identifiers = [re.findall(r"^    id: (\w+)$", field, re.MULTILINE) for field in fields]
    assert len({name for found in identifiers for name in found}) == len(fields), "an id each, none twice"
    assert all(field.startswith(("textarea\n", "input\n", "dropdown\n")) for field in fields)
    assert all("\n      label: " in field for field in fields)


def test_the_forms_exist_and_so_do_their_links() -> None:
    assert len(FORMS) == 3
    config = (ROOT / ".github/ISSUE_TEMPLATE/config.yml").read_text(encoding="utf-8")
    pages = re.findall(r"https://github\.com/cspdiag/cspdiag/blob/main/(\S+)", config)
    assert pages
    assert [page for page in pages if not (ROOT / page).is_file()] == []
