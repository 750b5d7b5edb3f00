"""A counterexample as a table over time: a row for each step, a column for each process."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby, takewhile

from cspdiag.base import Span
from cspdiag.base.render.snippet import on_one_line, printable
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Party, Step
from cspdiag.proofs.counterexamples.rounds import Repeated, shortened

_MARKS = {"!": "writes", "?": "reads", "*": "does something else"}
_MOST_LINES = 3
"""At most this number of lines of a process in one round are shown side by side."""
_KINDS = {"sample": "sample", "miss": "missed", "exception": "raise", "failure": "raise", "ready": "ready"}


def table(found: Counterexample, width: int = 120) -> str:
    """The steps that a diagram shows, with the line of the text in the column of each process that takes part; empty if
    there are none.

    ``!`` marks a process that writes, ``?`` one that reads, ``*`` one that does something else; a legend explains the
    marks, and where the branches are that have numbers for names. If the names of the processes would make the table
    wider than ``width`` characters, the columns have numbers, and the names follow below.
    """
    steps = [step for step in found.steps if step.shown]
    cycle = [step for step in found.cycle if step.shown]
    parties = [party for step in (*steps, *cycle) for party in step.parties]
    branches = {party.name: party.branch for party in parties if party.branch is not None}
    names = _in_text_order(list(dict.fromkeys(party.name for party in parties if party.role != ".")), branches)
    silent = f"{_silent_round(found)}\n" if found.cycle and not cycle else ""
    if not names:
        return silent
    files = {party.span.file for party in parties if party.span is not None}
    rows = list(_rows((*steps, *cycle), names, found.process, shows_files=len(files) > 1))
    lines = _aligned([["", "", *names], *rows])
    legend = [f"lines of {printable(file)}" for file in files] if len(files) == 1 else []
    legend.append(_key(cell for row in rows for cell in row[2:]))
    where = _where(names, branches, shows_files=len(files) > 1)
    if max(map(len, lines)) > width:
        lines = _aligned([["", "", *(f"({number})" for number in range(1, len(names) + 1))], *rows])
        legend = [f"({number}) {name}" for number, name in enumerate(names, start=1)] + legend
    if cycle:
        lines.insert(len(lines) - len(cycle), "then again and again:")
    below = (*_wrapped(legend, width), *_wrapped(where, width))
    return "".join(f"{line}\n" for line in lines) + silent + "".join(f"{line}\n" for line in below)


def _in_text_order(names: Sequence[str], branches: Mapping[str, Span]) -> list[str]:
    """The names, with the branches of each process put into the order of the text; replicated branches, which have the
    same text, are ordered by their numbers.
    """
    ordered = list(names)
    numbered: dict[str, list[int]] = {}
    for position, name in enumerate(names):
        if name in branches:
            numbered.setdefault(name.rpartition(".")[0], []).append(position)
    for positions in numbered.values():
        in_order = sorted(
            (names[position] for position in positions), key=lambda name: (branches[name].start, _number(name))
        )
        for position, name in zip(positions, in_order, strict=True):
            ordered[position] = name
    return ordered


def _number(name: str) -> int:
    """The number in the name of a branch, ``b.3`` or ``b.3 (2)``."""
    return int(name.rpartition(".")[2].partition(" ")[0])


def _where(names: Iterable[str], branches: Mapping[str, Span], *, shows_files: bool) -> Iterator[str]:
    """``4, 5: branches in line 14``, for each line of the text in which branches begin that have numbers for names."""
    at = [(name, branches[name]) for name in names if name in branches]
    for (file, line), group in groupby(at, key=lambda entry: (entry[1].file, entry[1].line)):
        together = [name for name, _ in group]
        place = f"at {on_one_line(file).rpartition('/')[2]}:{line}" if shows_files else f"in line {line}"
        yield f"{', '.join(together)}: branch{'es' * (len(together) > 1)} {place}"


def _silent_round(found: Counterexample) -> str:
    """The line for a cycle without any step that a diagram shows: which processes loop, and where in the text."""
    parties = {party.name: party for step in reversed(found.cycle) for party in step.parties}
    who = (f"`{name}`" + ("" if party.span is None else f" ({party.span})") for name, party in parties.items())
    return f"then again and again, without a communication or a delay: {', '.join(who)}"


def _key(cells: Iterable[str]) -> str:
    """The legend of the marks that are used."""
    marks = {mark for cell in cells for word in cell.split() for mark in takewhile(_MARKS.__contains__, word)}
    return ", ".join(f"{mark} {meaning}" for mark, meaning in _MARKS.items() if mark in marks)


def _rows(steps: Sequence[Step], names: Sequence[str], process: str, *, shows_files: bool) -> Iterator[list[str]]:
    """A row for each step, or for all rounds of a loop; the numbers count single steps."""
    number = 1
    for part in shortened(steps):
        last = number + part.times * len(part.steps) - 1
        if part.times > 1:
            cells = (_cell_of_rounds(part.steps, name, shows_files) for name in names)
            yield [f"{number}-{last}", f"{part.times} more rounds{_given(part, process)}", *cells]
        else:
            yield _row(number, part.steps[0], names, process, shows_files)
        number = last + 1


def _given(part: Repeated, process: str) -> str:
    """What is communicated in each round."""
    return "".join(f", {step.channel.removeprefix(f'{process}.')} {step.value}" for step in part.steps if step.value)


def _row(number: int, step: Step, names: Sequence[str], process: str, shows_files: bool) -> list[str]:
    taking_part = {party.name: party for party in step.parties}
    cells = (_cell(step, taking_part[name], shows_files) if name in taking_part else "" for name in names)
    return [str(number), event_text(step, process), *cells]


def event_text(step: Step, process: str) -> str:
    """What happens in a step, without the parties: ``fork[1] 3``, ``sample feedback``, ``wait 10 ms``."""
    channel = step.channel.removeprefix(f"{process}.")
    if step.kind == "time":
        channel = channel.rpartition(": ")[2]
    value = "" if step.value is None else f" {step.value}"
    return " ".join(filter(None, (_KINDS.get(step.kind, ""), channel))) + value


def _cell(step: Step, party: Party, shows_file: bool) -> str:
    return f"{_direction(step, party)}{_place(party, shows_file)}"


def _cell_of_rounds(steps: Sequence[Step], name: str, shows_file: bool) -> str:
    """What a process does in each round, by line; only the first line if there are many."""
    marks: dict[str, dict[str, None]] = {}
    for step in steps:
        for party in (party for party in step.parties if party.name == name):
            marks.setdefault(_place(party, shows_file), {})[_direction(step, party)] = None
    if len(marks) > _MOST_LINES:
        return f"*{next(iter(marks))}"
    return " ".join(f"{''.join(of_line)}{line}" for line, of_line in marks.items())


def _place(party: Party, shows_file: bool) -> str:
    if party.span is None:
        return ""
    return (
        f" {on_one_line(party.span.file).rpartition('/')[2]}:{party.span.line}" if shows_file else str(party.span.line)
    )


def _direction(step: Step, party: Party) -> str:
    if step.kind == "ready":
        return "*"
    if party.role:
        return party.role
    direction = _known_direction(party)
    others = [other for other in step.parties if other is not party]
    if direction is None and len(others) == 1 and step.kind == "communication":
        return {"!": "?", "?": "!"}.get(_known_direction(others[0]) or "", "*")
    return direction or "*"


def _known_direction(party: Party) -> str | None:
    if "to write" in party.words:
        return None if "to read" in party.words else "!"
    return "?" if "to read" in party.words else None


def _aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join(_padded(row, widths)).rstrip() for row in rows]


def _padded(row: Sequence[str], widths: Sequence[int]) -> Iterator[str]:
    for column, (cell, width) in enumerate(zip(row, widths, strict=True)):
        yield cell.rjust(width) if column == 0 else cell.ljust(width)


def _wrapped(parts: Iterable[str], width: int) -> Iterator[str]:
    line = ""
    for part in parts:
        if line and len(line) + 2 + len(part) > width:
            yield line
            line = ""
        line = f"{line}  {part}" if line else part
    if line:
        yield line
