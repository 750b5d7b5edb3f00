"""Changes as text: a heading for each definition, and a line for each change with its sign."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from cspdiag.draw.differences.change import Action, Change

SIGNS: dict[Action, str] = {"added": "+", "removed": "-", "changed": "~", "renamed": "~"}
_COLOURS: dict[Action, str] = {"added": "32", "removed": "31", "changed": "33", "renamed": "33"}

LONGEST = 60
"""Characters of the name of a changed connection that are shown."""


def render(changes: Iterable[Change], *, colour: bool = False) -> str:
    """All changes, grouped by definition; an empty text for none."""
    lines: list[str] = []
    heading = ""
    for change in changes:
        of = f"{change.kind} {change.definition}"
        if change.subject == "" and change.action != "changed":
            lines.append(_painted(f"{SIGNS[change.action]} {_whole(change)}", change, colour))
            heading = of if change.action == "renamed" else ""
            continue
        if of != heading:
            lines.append(f"  {of}")
            heading = of
        lines += [_painted(f"{'    '}{line}", change, colour) for line in sentence_lines(change)]
    return "".join(f"{line}\n" for line in lines)


def sentence(change: Change) -> str:
    """A change in one line without its sign, as it stands below a picture."""
    if change.subject == "" and change.action != "changed":
        return _whole(change)
    if change.action == "changed" and change.subject == "composition":
        return f"composition {change.before or 'none'} → {change.after or 'none'}"
    return " ".join(line.strip() for line in sentence_lines(change))[2:]


def sentence_lines(change: Change) -> Iterator[str]:
    """The lines for a change within a definition, the first with its sign."""
    sign = SIGNS[change.action]
    subject = f"{change.subject} " if change.subject else ""
    match change.action:
        case "added":
            yield f"{sign} {subject}{change.after}"
        case "removed":
            yield f"{sign} {subject}{change.before}"
        case "renamed":
            yield f"{sign} {subject}{change.before} is now called {change.after}"
        case "changed" if change.subject == "composition":
            yield f"{sign} composition"
            yield f"    - {change.before}"
            yield f"    + {change.after}"
        case "changed" if change.aspect in ("from", "to"):
            words = "from" if change.aspect == "from" else "to"
            ends = [f"no longer {words} {change.before}"] if change.before else []
            ends += [f"now {words} {change.after}"] if change.after else []
            yield f"{sign} {subject}{_short(change.name)}: {', '.join(ends)}"
        case "changed":
            name = f"{_short(change.name)}: " if change.name else ""
            aspect = f"{change.aspect} " if change.aspect else ""
            yield f"{sign} {subject}{name}{aspect}{change.before or 'none'} → {change.after or 'none'}"


def _short(name: str) -> str:
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"


def _whole(change: Change) -> str:
    """A definition that came, went or has another name."""
    if change.action == "renamed":
        return f"{change.kind} {change.before} is now called {change.after}"
    return f"{change.kind} {change.after if change.action == 'added' else change.before}"


def _painted(line: str, change: Change, colour: bool) -> str:
    return f"\x1b[{_COLOURS[change.action]}m{line}\x1b[0m" if colour else line
