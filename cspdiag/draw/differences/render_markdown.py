"""Changes as Markdown, for a comment on a change of a program: coloured as a difference where that is known."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from cspdiag.draw.differences.change import Change
from cspdiag.draw.differences.programs import Difference
from cspdiag.draw.differences.render_text import SIGNS, reported, sentence


def render(
    name: str, difference: Difference, problems: Sequence[str] = (), picture: str | None = None, *, former: str = ""
) -> str:
    """A section about one program. ``problems`` are the reasons why not everything could be compared, a line each;
    ``picture`` is the address of a picture of the changes, ``former`` the earlier name of the file.
    """
    parts = [f"### {_code(name)}{f' (was {_code(former)})' if former not in ('', name) else ''}"]
    if problems:
        parts.append(f"Not everything could be read:\n\n{_fenced('text', problems)}")
    if difference.uncompared:
        parts.append(f"Not compared: {', '.join(map(_code, difference.uncompared))}.")
    if picture is not None and difference.changes:
        parts.append(f"![What changed in the diagrams of {_escaped(name)}]({_address(picture)})")
    if difference.changes:
        parts.append(_fenced("diff", _lines(difference.changes)))
    elif not problems:
        parts.append("Nothing changed in the diagrams.")
    return "\n\n".join(parts) + "\n"


def _lines(changes: Iterable[Change]) -> Iterable[str]:
    heading = ""
    for change in reported(changes):
        sign = SIGNS[change.action].replace("~", "!")
        of = f"@@ {change.kind} {change.definition} @@"
        if change.subject or change.action == "changed":
            if of != heading:
                yield of
                heading = of
        else:
            heading = ""
        yield f"{sign} {sentence(change)}"


def _fenced(language: str, lines: Iterable[str]) -> str:
    text = "\n".join(lines)
    longest = max(map(len, re.findall("`+", text)), default=0)
    fence = "`" * max(3, longest + 1)
    return f"{fence}{language}\n{text}\n{fence}"


def _code(text: str) -> str:
    longest = max(map(len, re.findall("`+", text)), default=0)
    mark = "`" * (longest + 1)
    space = " " if longest else ""
    return f"{mark}{space}{text}{space}{mark}"


def _escaped(text: str) -> str:
    return re.sub(r"([\\`*_{}\[\]<>()#!|])", r"\\\1", text)


def _address(path: str) -> str:
    from urllib.parse import quote

    return quote(path, safe="/:.")
