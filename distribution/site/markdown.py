"""Turns a page of the repository into a page of the site: links, pictures, programs and commands."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Literal

from cspdiag.base import Report, SourceFile
from cspdiag.syntax.parser import parse
from distribution.site.playground import fragment, program_of
from distribution.site.shell import ROOT, Shell

_FENCE = re.compile(
    r"^(?:<!-- (?P<mark>\S+) -->\n)?(?P<block>(?P<indent> *)(?P<ticks>`{3,})(?P<language>[\w-]*)(?P<info>[^\n`]*)\n"
    r"(?P<text>.*?)^(?P=indent)(?P=ticks) *\n)",
    re.MULTILINE | re.DOTALL,
)
_LINK = re.compile(r"(?P<picture>!?)\[(?P<text>(?:[^\[\]]|\[[^\[\]]*\])*)\]\((?P<target>[^)\s]+)\)")
_SHOW = re.compile(r"^<!-- show (?P<path>\S+)(?: (?P<name>\w+))? -->$", re.MULTILINE)
_LONG = 60
"""Lines of output that are shown without being asked for."""

Playground = Literal["linked", "absent"]


@dataclass
class Block:
    """A fenced block: what precedes it in a comment, its language and text, and the whole as it was written."""

    mark: str
    language: str
    name: str
    text: str
    written: str
    indent: str


@dataclass
class Page:
    """A page on its way to the site; ``place`` has no suffix."""

    source: Path
    place: str
    shell: Shell | None = None
    """Where the commands of the page are run, if they are."""
    playground: Playground = "linked"
    programs: list[tuple[dict[str, str], str]] = field(default_factory=list)
    """The programs of the page that open in the playground."""

    @property
    def up(self) -> str:
        """The way from the page to the top of the site."""
        return "../" * self.place.count("/")


Resolve = Callable[[Page, str], str]
"""The target of a link on a page, and where it leads on the site."""
Show = Callable[[Page, str, str], str | None]
"""The text and the target of a picture on a page, and the Markdown that shows it; None if there is no such file."""


def parts(text: str) -> Iterator[str | Block]:
    """A text as prose and fenced blocks, in order."""
    at = 0
    for found in _FENCE.finditer(text):
        yield text[at : found.start()]
        yield Block(
            found["mark"] or "",
            found["language"],
            found["info"].strip(),
            _without_indent(found["text"], found["indent"]),
            found["block"],
            found["indent"],
        )
        at = found.end()
    yield text[at:]


def converted(page: Page, text: str, resolve: Resolve, show: Show) -> str:
    """The page for the site."""
    written: list[str] = []
    for part in parts(text):
        if isinstance(part, str):
            written.append(prose(page, part, resolve, show))
        else:
            written.append(part.written + _below(page, part, text, show))
    return "".join(written)


def is_program(text: str) -> bool:
    """Whether a text is a program that stands alone, right or wrong in its meaning: it can be read, and imports
    nothing from other files.
    """
    report = Report()
    tree = parse(SourceFile(name="program.csp", text=text), report)
    return not report.has_errors and bool(tree.items) and 'import "' not in text


def play_link(page: Page, files: dict[str, str], main: str) -> str:
    """HTML with a link that opens a program in the playground; empty if the site has none."""
    if page.playground == "absent":
        return ""
    page.programs.append((files, main))
    address = escape(f"{page.up}playground/{fragment(files, main)}")
    return f'\n<p class="play"><a href="{address}">Open in the playground</a></p>\n'


def details(summary: str, text: str, language: str = "text") -> str:
    """A block that is folded."""
    return f"\n<details><summary>{summary}</summary>\n\n{fenced(text, language)}\n</details>\n"


def fenced(text: str, language: str) -> str:
    """A text as a fenced block, whatever it contains."""
    ticks = "`" * max([3, *(len(run) + 1 for run in re.findall("`{3,}", text))])
    return f"{ticks}{language}\n{text.rstrip()}\n{ticks}\n"


def _below(page: Page, block: Block, text: str, show: Show) -> str:
    """What is added below a block of a page with this text: a link to the playground, or the output of its commands
    and the pictures that they wrote, if the page does not show them itself.
    """
    if block.language == "csp":
        if page.shell is not None and block.mark:
            page.shell.write(block.mark, block.text)
            return play_link(page, *program_of(page.shell.folder / block.mark))
        if is_program(block.text) and not block.indent:
            return play_link(page, {"program.csp": block.text}, "program.csp")
    if block.language == "sh" and block.mark == "run":
        if page.shell is None:
            raise ValueError(f"{page.source}: its commands are not run when the site is built")
        before = page.shell.pictures
        output = re.sub(r"^wrote \S+\.svg\n", "", page.shell.run(block.text), flags=re.MULTILINE)
        lines = output.count("\n")
        output = fenced(output, "text") if lines <= _LONG else details(f"Output, {lines} lines", output)
        pictures = [name for name in sorted(page.shell.pictures - before) if f"]({name})" not in text]
        return "\n".join(["", *[output] * bool(lines), *(f"{show(page, name, name)}\n" for name in pictures)])
    return ""


def prose(page: Page, text: str, resolve: Resolve, show: Show) -> str:
    """Text between blocks, with the links and pictures of the site."""

    def replaced(found: re.Match[str]) -> str:
        target = found["target"]
        if found["picture"]:
            return show(page, " ".join(found["text"].split()), target) or found[0]
        if found["text"].startswith("!["):
            return found[0]
        return f"[{found['text']}]({resolve(page, target)})"

    return _LINK.sub(replaced, _SHOW.sub(lambda found: _shown(page, found["path"], found["name"]), text))


def _shown(page: Page, path: str, name: str | None) -> str:
    """A program of the repository, or a definition in it, with a link that opens the whole."""
    file = ROOT / path
    text = file.read_text(encoding="utf-8")
    if name is not None:
        found = re.search(rf"^(///[^\n]*\n)*\w+ {name}\b.*?^}}\n", text, re.MULTILINE | re.DOTALL)
        if found is None:
            raise ValueError(f"{page.source}: there is no {name} in {path}")
        text = found[0]
    return fenced(text, "csp") + play_link(page, *program_of(file))


def _without_indent(text: str, indent: str) -> str:
    return "".join(line.removeprefix(indent) for line in text.splitlines(keepends=True)) if indent else text


def relative(target: str, page: Page) -> str:
    """A place on the site as seen from a page."""
    return os.path.relpath(target, Path(page.place).parent).replace(os.sep, "/")
