"""What the pages for maintainers refer to exists: links, sections, files, functions and tests.

A place is written as `path` or `path::name` in backquotes, relative to the top of the repository; a name may be dotted
(`Task.cancel`).
"""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from cspdiag.runtime import After, Channel, Network, Process, interrupt, ms, wait

ROOT = Path(__file__).parents[2]
DESIGN = sorted((ROOT / "docs" / "design").glob("*.md"))
DECISIONS = [page for page in DESIGN if page.name != "README.md"]
LINKED = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    ROOT / "llms.txt",
    *sorted((ROOT / "docs").glob("*.md")),
    *DESIGN,
]
ARCHITECTURE = ROOT / "docs" / "architecture.md"
NAMING = [*DESIGN, ARCHITECTURE, ROOT / "docs" / "releasing.md", ROOT / ".github" / "pull_request_template.md"]
SECTIONS = ["Decision", "Alternatives", "What it costs", "In the code", "Tests"]
FOLDERS = "cspdiag|tests|docs|models|templates|grammars|distribution|benchmarks|third-party"
_PLACE = re.compile(rf"`((?:(?:{FOLDERS})/|\.ci/|\.github/)[\w./-]*|Makefile|[\w-]+\.(?:toml|md))(?:::([\w.]+))?`")
_LINK = re.compile(r"\]\(([^)\s]+)\)")
_CODE = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def anchors(text: str) -> set[str]:
    """The anchors that GitHub gives to the headings of a page."""
    headings = re.findall(r"^#+ (.+)$", _CODE.sub("", text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def dead_links(page: Path) -> list[str]:
    dead = []
    for link in _LINK.findall(_CODE.sub("", page.read_text(encoding="utf-8"))):
        if "://" in link:
            continue
        target, _, anchor = link.partition("#")
        file = page.parent / target if target else page
        if not file.exists() or (anchor and anchor not in anchors(file.read_text(encoding="utf-8"))):
            dead.append(link)
    return dead


def names_in(body: list[ast.stmt], prefix: str = "") -> Iterator[str]:
    """The functions, classes and variables of a module; methods and attributes with the name of their class."""
    for statement in body:
        if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield prefix + statement.name
            if isinstance(statement, ast.ClassDef):
                yield from names_in(statement.body, f"{prefix}{statement.name}.")
        elif isinstance(statement, ast.Assign | ast.AnnAssign):
            targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
            yield from (prefix + target.id for target in targets if isinstance(target, ast.Name))


def places(text: str) -> list[tuple[str, str]]:
    return _PLACE.findall(text)


def missing_places(text: str) -> list[str]:
    missing = []
    for path, name in places(text):
        file = ROOT / path
        if not file.exists():
            missing.append(path)
        elif name:
            content = file.read_text(encoding="utf-8")
            found = set(names_in(ast.parse(content).body)) if file.suffix == ".py" else set(re.findall(r"\w+", content))
            if name not in found:
                missing.append(f"{path}::{name}")
    return missing


def sections(page: Path) -> dict[str, str]:
    parts = re.split(r"^## (.+)$\n", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


@pytest.mark.parametrize("page", LINKED, ids=name_of)
def test_links_have_targets(page: Path) -> None:
    assert dead_links(page) == []


def test_the_list_for_language_models_has_the_form_of_llmstxt_org() -> None:
    title, summary, details, *lists = (ROOT / "llms.txt").read_text(encoding="utf-8").strip().split("\n\n")
    assert title.startswith("# ")
    assert summary.startswith("> ")
    assert details.strip()
    for heading, links in zip(lists[::2], lists[1::2], strict=True):
        assert re.fullmatch(r"## .+", heading)
        assert [line for line in links.splitlines() if not re.fullmatch(r"- \[.+\]\(\S+\): .+", line)] == []


@pytest.mark.parametrize("page", NAMING, ids=name_of)
def test_places_in_the_code_exist(page: Path) -> None:
    assert missing_places(page.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("page", DECISIONS, ids=name_of)
def test_a_page_of_a_decision_answers_what_an_engineer_would_ask(page: Path) -> None:
    found = sections(page)
    assert list(found) == SECTIONS
    assert all(text.strip() for text in found.values())
    assert any(path.startswith(("cspdiag/", "templates/")) for path, _ in places(found["In the code"]))
    assert any(path.startswith("tests/") for path, _ in places(found["Tests"]))


def test_the_index_has_every_decision_once() -> None:
    index = (ROOT / "docs" / "design" / "README.md").read_text(encoding="utf-8")
    assert sorted(link for link in _LINK.findall(index) if "/" not in link) == [page.name for page in DECISIONS]
    titles = {page.name: page.read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ") for page in DECISIONS}
    assert [name for name, title in titles.items() if f"- [{title}]({name})\n" not in index] == []


def test_the_table_of_folders_has_every_layer() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    (order,) = (contract["layers"] for contract in contracts if contract["type"] == "layers")
    layers = {part.strip(" ()") for level in order for part in level.split("|")}
    folders = re.findall(r"^\| `cspdiag/(\w+)(?:/|\.py)` \|", ARCHITECTURE.read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(folders) == sorted(layers)


class Interrupted(Process):
    """Waits in a rendezvous, is interrupted there, and ends in the handler."""

    def __init__(self) -> None:
        super().__init__("Top")
        self.numbers = Channel[int]("Top.numbers")

    async def run(self) -> None:
        await interrupt(self.reads, After(ms), self.continues)

    async def reads(self) -> None:
        await self.numbers.reader(self).read()

    async def continues(self) -> None:
        await wait(ms)


def calls_of(process: Process) -> list[str]:
    """Every function of cspdiag that a run of the process calls, as ``path::name``, in order."""
    calls: list[str] = []

    def note(frame: Any, event: str, _: object) -> None:
        if event == "call" and frame.f_code.co_filename.startswith(f"{ROOT}/cspdiag/"):
            path = Path(frame.f_code.co_filename).relative_to(ROOT).as_posix()
            calls.append(f"{path}::{frame.f_code.co_qualname}")

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        outcome = Network(process).run()
    finally:
        sys.setprofile(before)
    assert outcome.ended == "terminated", outcome.error
    return calls


def test_the_walk_follows_the_calls_of_an_interrupt() -> None:
    walk = ARCHITECTURE.read_text(encoding="utf-8").partition("## A walk\n")[2].partition("In C it is")[0]
    steps = [f"{path}::{name}" for path, name in places(walk) if name]
    assert len(re.findall(r"^\d\. ", walk, re.MULTILINE)) == 7, "seven steps, as the page says"
    assert len(steps) == 7
    calls = iter(calls_of(Interrupted()))
    assert [step for step in steps if step not in calls] == [], "in this order"


def test_what_does_not_exist_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("# Here\n\n[a](#here) [b](#there) [c](page.md#here) [d](gone.md) [e](https://example.org)\n")
    assert dead_links(page) == ["#there", "gone.md"]
    text = "`cspdiag/pipeline.py::check` `cspdiag/gone.py` `cspdiag/pipeline.py::gone` `tests/gone/` `Makefile` `a/b`"
    assert missing_places(text) == ["cspdiag/gone.py", "cspdiag/pipeline.py::gone", "tests/gone/"]
