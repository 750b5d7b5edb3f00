"""A counterexample as a table over time: a row for each step, and, if they are few, a column for each process."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from itertools import groupby, takewhile

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.base.render.snippet import on_one_line, printable
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Party, Step
from cspdiag.proofs.counterexamples.rounds import Repeated, shortened

_MARKS = {"!": "writes", "?": "reads", "*": "does something else"}
_MOST_LINES = 3
"""At most this number of lines of a process in one round are shown side by side."""
_MOST_COLUMNS = 20
"""With more processes than this, each row names those who take part."""
_KINDS = {"sample": "sample", "miss": "missed", "exception": "raise", "failure": "raise", "ready": "ready"}


@record
class _Row:
    number: str
    event: str
    cells: Mapping[str, str]
    """What each process does that takes part, with the line of the text."""


def table(found: Counterexample, width: int = 120) -> str:
    """The steps that a diagram shows, with the line of the text in the column of each process that takes part; empty if
    there are none.

    ``!`` marks a process that writes, ``?`` one that reads, ``*`` one that does something else; a legend explains the
    marks, and where the branches are that have numbers for names. If the names of the processes would make the table
    wider than ``width`` characters, the columns have numbers, and the names follow below. With too many processes for
    columns, each row names those who take part.
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
    rows = list(_rows((*steps, *cycle), set(names), found.process, shows_files=len(files) > 1))
    legend = [f"lines of {printable(file)}" for file in files] if len(files) == 1 else []
    legend.append(_key(cell for row in rows for cell in row.cells.values()))
    where = _where(names, branches, shows_files=len(files) > 1)
    lines, numbered = _laid_out(rows, names, width)
    if cycle:
        lines.insert(len(lines) - len(cycle), "then again and again:")
    below = (*_wrapped((*numbered, *legend), width), *_wrapped(where, width))
    return "".join(f"{line}\n" for line in lines) + silent + "".join(f"{line}\n" for line in below)


def _laid_out(rows: Sequence[_Row], names: Sequence[str], width: int) -> tuple[list[str], list[str]]:
    """The lines of the table, which begins with a heading, and the names of the columns that have numbers."""
    if len(names) > _MOST_COLUMNS:
        parts = [", ".join(f"{name} {cell.strip()}" for name, cell in row.cells.items()) for row in rows]
        named = [[row.number, row.event, part] for row, part in zip(rows, parts, strict=True)]
        return _aligned([["", "", "who takes part"], *named]), []
    cells = [[row.number, row.event, *(row.cells.get(name, "") for name in names)] for row in rows]
    lines = _aligned([["", "", *names], *cells])
    if max(map(len, lines)) <= width:
        return lines, []
    numbers = [f"({number})" for number in range(1, len(names) + 1)]
    numbered = [f"{number} {name}" for number, name in zip(numbers, names, strict=True)]
    return _aligned([["", "", *numbers], *cells]), numbered


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


def _rows(steps: Sequence[Step], names: Container[str], process: str, *, shows_files: bool) -> Iterator[_Row]:
    """A row for each step, or for all rounds of a loop; the numbers count single steps."""
    number = 1
    for part in shortened(steps):
        last = number + part.times * len(part.steps) - 1
        if part.times > 1:
            event = f"{part.times} more rounds{_given(part, process)}"
            yield _Row(f"{number}-{last}", event, _cells_of_rounds(part.steps, names, shows_files))
        else:
            yield _row(number, part.steps[0], names, process, shows_files)
        number = last + 1


def _given(part: Repeated, process: str) -> str:
    """What is communicated in each round."""
    return "".join(f", {step.channel.removeprefix(f'{process}.')} {step.value}" for step in part.steps if step.value)


def _row(number: int, step: Step, names: Container[str], process: str, shows_files: bool) -> _Row:
    cells = {party.name: _cell(step, party, shows_files) for party in step.parties if party.name in names}
    return _Row(str(number), event_text(step, process), cells)


def event_text(step: Step, process: str) -> str:
    """What happens in a step, without the parties: ``fork[1] 3``, ``sample feedback``, ``wait 10 ms``."""
    channel = step.channel.removeprefix(f"{process}.")
    if step.kind == "time":
        channel = channel.rpartition(": ")[2]
    value = "" if step.value is None else f" {step.value}"
    return " ".join(filter(None, (_KINDS.get(step.kind, ""), channel))) + value


def _cell(step: Step, party: Party, shows_file: bool) -> str:
    return f"{_direction(step, party)}{_place(party, shows_file)}"


def _cells_of_rounds(steps: Sequence[Step], names: Container[str], shows_file: bool) -> dict[str, str]:
    """What each process does in a round, by line; only the first line if there are many."""
    marks: dict[str, dict[str, dict[str, None]]] = {}
    for step in steps:
        for party in step.parties:
            if party.name in names:
                of_line = marks.setdefault(party.name, {}).setdefault(_place(party, shows_file), {})
                of_line[_direction(step, party)] = None
    return {name: _of_lines(lines) for name, lines in marks.items()}


def _of_lines(marks: Mapping[str, Iterable[str]]) -> str:
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
