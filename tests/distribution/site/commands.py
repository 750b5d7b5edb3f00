"""The commands of a page in the order of its reader: what is saved before them, and what they are shown to print."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from distribution.site.markdown import Block, parts
from distribution.site.shell import without_times

_INDENTED = re.compile(r"(?<=\n\n)((?: {4}[^\n]*\n|\n(?= {4}))+)")
_OMITTED = {"...", "…"}
"""Lines in place of any lines of output that are not shown."""


@dataclass
class Saved:
    """A file that the page shows and its reader has then."""

    name: str
    text: str


@dataclass
class Command:
    """A line that is typed, without its comment, and the lines that are shown below it; none if none are shown."""

    line: str
    shown: list[str] = field(default_factory=list)


def steps(page: str) -> Iterator[Saved | Command]:
    """What a reader does who leaves nothing out."""
    pieces = list(_pieces(page))
    for piece, after in zip(pieces, [*pieces[1:], ""], strict=True):
        if isinstance(piece, str):
            continue
        if "." in (name := piece.mark or piece.name):
            yield Saved(name, piece.text)
        elif piece.language in ("", "sh", "console", "text"):
            typed = commands(piece.text)
            if typed and isinstance(after, Block) and after.language == "text" and not commands(after.text):
                typed[-1].shown = after.text.splitlines()
            yield from typed


def _pieces(page: str) -> Iterator[str | Block]:
    """The page as prose and blocks, of which indented ones are those of a terminal; what is between two is left out
    if it is empty.
    """
    for part in parts(page):
        if isinstance(part, Block):
            yield part
            continue
        for at, text in enumerate(_INDENTED.split(part)):
            if at % 2:
                yield Block("", "sh", "", re.sub(r"^ {4}", "", text, flags=re.MULTILINE), text, "")
            elif text.strip():
                yield text


def commands(text: str) -> list[Command]:
    """The commands of a block; where a prompt marks them, the other lines are what they print."""
    lines = text.replace("\\\n", " ").splitlines()
    if not any(line.startswith("$ ") for line in lines):
        return [Command(_without_comment(line)) for line in lines if line.startswith(("cspdiag ", "git "))]
    found: list[Command] = []
    for line in lines:
        if line.startswith("$ "):
            found.append(Command(_without_comment(line.removeprefix("$ "))))
        elif found:
            found[-1].shown.append(line)
    return found


def _without_comment(line: str) -> str:
    return re.sub(r" +# .*$", "", line).strip()


def differences(shown: Sequence[str], printed: str) -> list[str]:
    """The lines that a page shows of a command and that it does not print there.

    What is shown is the whole, without lines that are said to be left out, files that are written, and times that it
    takes.
    """
    rest = _lines(printed)
    missing = []
    may_skip = False
    for line in _lines("\n".join(shown)):
        if line.strip() in _OMITTED:
            may_skip = True
            continue
        if line in (rest if may_skip else rest[:1]):
            rest = rest[rest.index(line) + 1 :]
        else:
            missing.append(line)
        may_skip = False
    return missing + ([f"not shown: {line}" for line in rest] if not missing and not may_skip else [])


def _lines(text: str) -> list[str]:
    kept = re.sub(r"^wrote \S+\n?", "", without_times(text.strip("\n")), flags=re.MULTILINE)
    return [line.rstrip() for line in kept.splitlines()]
