"""The tasks: Markdown files with a request, a program to start from, checks, and attempts with known results.

A file has the request below its title, and these sections: ``Start``, a whole program; ``Checks``, a line for each
check (``checks.py`` has the vocabulary) and, in a ``csp`` block, definitions that are added to an attempt before it is
judged, whose names begin with ``Judge``; ``Solution``; and ``Wrong: ...``, attempts that an engineer might make, each
with the check in which it fails. A solution and a wrong attempt consist of the definitions that differ from the
start: those with a name that is there already replace the old ones.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

TASKS = Path(__file__).parent / "tasks"
_BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_DEFINITION = re.compile(
    r"(?:process|submodel|driver|environment|struct|enum|exception|const|parameter|type|import|assert)\b"
)


class Wrong(NamedTuple):
    """An attempt with the check that it fails; if it does not compile, with the code of the error."""

    title: str
    text: str
    fails: str


class Task(NamedTuple):
    """What is requested, and how attempts are judged; all programs are whole."""

    name: str
    title: str
    request: str
    start: str
    checks: tuple[str, ...]
    judge: str
    solution: str
    wrong: tuple[Wrong, ...]

    @property
    def number(self) -> str:
        """The two digits with which its name begins."""
        return self.name[:2]


def all_tasks() -> list[Task]:
    """The tasks in the order of their numbers."""
    return [read_task(path) for path in sorted(TASKS.glob("*.md"))]


def read_task(path: Path) -> Task:
    """The task in a file."""
    head, *parts = re.split(r"^## (.+)\n", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
    title, _, request = head.removeprefix("# ").partition("\n")
    sections = dict(zip(parts[::2], parts[1::2], strict=True))
    start = _blocks(sections["Start"], "csp")[0]
    wrong = [
        Wrong(heading.removeprefix("Wrong: "), with_changes(start, _blocks(text, "csp")[0]), _failing(text))
        for heading, text in sections.items()
        if heading.startswith("Wrong: ")
    ]
    return Task(
        name=path.stem,
        title=title,
        request=request.strip(),
        start=start,
        checks=tuple(_blocks(sections["Checks"], "checks")[0].splitlines()),
        judge="\n".join(_blocks(sections["Checks"], "csp")),
        solution=with_changes(start, _blocks(sections["Solution"], "csp")[0]),
        wrong=tuple(wrong),
    )


def _blocks(section: str, language: str) -> list[str]:
    return [text for kind, text in _BLOCK.findall(section) if kind == language]


def _failing(section: str) -> str:
    found = re.search(r"^Fails: `(.+)`$", section, re.MULTILINE)
    assert found is not None, "a wrong attempt says in which check it fails"
    return found[1]


def definitions(text: str) -> dict[str, str]:
    """The definitions of a program in the standard format by kind and name, with their comments. A parameter counts as
    a constant, so that it can replace one.
    """
    found: dict[str, str] = {}
    lines: list[str] = []
    for line in [*text.splitlines(keepends=True), "end"]:
        if (_begins(line) or line == "end") and lines and _name(lines):
            comment = next((at for at in range(len(lines), 0, -1) if not lines[at - 1].startswith("//")), 0)
            found[_name(lines)] = "".join(lines[:comment])
            lines = lines[comment:]
        lines.append(line)
    return found


def _begins(line: str) -> bool:
    return _DEFINITION.match(line) is not None


def _name(lines: list[str]) -> str:
    first = next((line for line in lines if _begins(line)), "")
    if first.startswith(("assert", "import")):
        return first.strip()
    if not first:
        return ""
    kind, name = re.findall(r"\w+", first)[:2]
    return f"{'const' if kind == 'parameter' else kind} {name}"


def with_changes(text: str, changes: str) -> str:
    """A program in which some definitions are replaced, and new ones come at the end."""
    merged = definitions(text) | definitions(changes)
    return "\n".join(f"{definition.strip()}\n" for definition in merged.values())
