"""Changes as text: a heading for each definition, and a line for each change with its sign."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.draw.differences.change import Action, Change

SIGNS: dict[Action, str] = {"added": "+", "removed": "-", "changed": "~", "renamed": "~"}
_COLOURS: dict[Action, str] = {"added": "32", "removed": "31", "changed": "33", "renamed": "33"}

WHOLE = 160
"""The length in characters up to which the compositions before and after are shown as a whole."""
LONGEST = 60
"""The number of characters shown of the name of a changed connection."""


def render(changes: Iterable[Change], *, colour: bool = False) -> str:
    """All changes, grouped by definition; an empty text for none."""
    lines: list[str] = []
    heading = ""
    for change in reported(changes):
        of = f"{change.kind} {change.definition}"
        if change.subject == "" and change.action != "changed":
            lines.append(_painted(f"{SIGNS[change.action]} {_whole(change)}", change, colour))
            heading = of if change.action == "renamed" else ""
            continue
        if of != heading:
            lines.append(f"  {of}")
            heading = of
        lines.append(_painted(f"    {sentence_line(change)}", change, colour))
    return "".join(f"{line}\n" for line in lines)


def reported(changes: Iterable[Change]) -> list[Change]:
    """The changes without those that others include: a short composition is reported as a whole, a long one by its
    steps.
    """
    given = list(changes)
    short = {
        change.definition
        for change in given
        if _is_whole_composition(change) and len(change.before or "") + len(change.after or "") <= WHOLE
    }
    return [
        change
        for change in given
        if change.subject != "composition" or _is_whole_composition(change) == (change.definition in short)
    ]


def _is_whole_composition(change: Change) -> bool:
    return change.subject == "composition" and not change.name


def sentence(change: Change) -> str:
    """A change in one line without its sign, as it is shown below a picture."""
    if change.subject == "" and change.action != "changed":
        return _whole(change)
    return sentence_line(change)[2:]


def sentence_line(change: Change) -> str:
    """The line for a change within a definition, with its sign."""
    sign = SIGNS[change.action]
    subject = f"{change.subject} " if change.subject else ""
    if change.subject == "composition":
        subject = f"composition: {change.name} " if change.name else "composition: "
    match change.action:
        case "added":
            return f"{sign} {subject}{change.after}"
        case "removed":
            return f"{sign} {subject}{change.before}"
        case "renamed":
            return f"{sign} {subject}{change.before} is now called {change.after}"
        case "changed" if change.aspect in ("from", "to"):
            ends = [f"no longer {change.aspect} {change.before}"] if change.before else []
            ends += [f"now {change.aspect} {change.after}"] if change.after else []
            return f"{sign} {subject}{_short(change.name)}: {', '.join(ends)}"
        case "changed":
            name = f"{_short(change.name)}: " if change.name and change.subject != "composition" else ""
            aspect = f"{change.aspect} " if change.aspect else ""
            return f"{sign} {subject}{name}{aspect}{change.before or 'none'} → {change.after or 'none'}"


def _short(name: str) -> str:
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"


def _whole(change: Change) -> str:
    """A definition that was added, removed or renamed."""
    if change.action == "renamed":
        return f"{change.kind} {change.before} is now called {change.after}"
    return f"{change.kind} {change.after if change.action == 'added' else change.before}"


def _painted(line: str, change: Change, colour: bool) -> str:
    return f"\x1b[{_COLOURS[change.action]}m{line}\x1b[0m" if colour else line
