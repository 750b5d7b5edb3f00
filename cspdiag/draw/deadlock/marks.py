"""Where waiting processes are in the communication diagram of the process around them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import takewhile
from typing import ClassVar

from cspdiag.base import Span
from cspdiag.base.record import EMPTY, record
from cspdiag.draw.elements.communication import communication_diagram
from cspdiag.draw.elements.diagram import Arrow, CommunicationDiagram
from cspdiag.draw.elements.facts import Facts
from cspdiag.draw.elements.marks import Mark
from cspdiag.model.program import Program
from cspdiag.syntax import ast
from cspdiag.syntax.walk import instances_in

_INDEX = re.compile(r"\[[^\]]*\]")
MOST_NUMBERS = 10
"""If more processes than these wait at one element, they are not numbered."""


@record
class StuckProcess:
    """A process that can never continue.

    ``path`` is that of the process (``Table.fork[1]``), ``words`` says what it waits for (``to read
    Table.philosopher[0].first``), ``place`` is the file and line, ``channels`` are the full names of the channels,
    ``ports`` those of its own ports that are connected to them. ``span`` is exactly where it waits, if that is known.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    path: str
    words: str
    place: str | None = None
    channels: tuple[str, ...] = ()
    ports: tuple[str, ...] = ()
    span: Span | None = None


def shortened(text: str, top: str) -> str:
    """A path, or words with paths, without the name of the outermost process; empty for that process itself."""
    return "" if text == top else re.sub(rf"(?<![\w.\]]){re.escape(top)}\.", "", text)


def surroundings(
    program: Program, top: str, waiting: Sequence[StuckProcess], declared: Mapping[str, Span] = EMPTY
) -> tuple[CommunicationDiagram, dict[str, Mark]] | None:
    """The diagram of the innermost process that contains all waiting processes, with marks on them, numbered in their
    order; None if there is no such process. ``declared`` has the places in the text at which channels are declared, by
    their full names: it distinguishes relationships that begin at elements of one array.
    """
    path = path_around(waiting)
    prefix = path.split(".")
    definition = definition_at(program, prefix) if prefix[0] == top else None
    if definition is None or definition.communication is None:
        return None
    diagram = communication_diagram(program, Facts(program), definition)
    return diagram, _marks(diagram, path, waiting, declared)


def marks_beside(
    diagram: CommunicationDiagram,
    processes: Sequence[StuckProcess],
    waiting: Sequence[StuckProcess],
    declared: Mapping[str, Span] = EMPTY,
) -> dict[str, Mark]:
    """Marks on the ``waiting`` processes that are in the diagram of the ``surroundings`` of some others."""
    prefix = path_around(processes)
    return _marks(diagram, prefix, [each for each in waiting if each.path.startswith(f"{prefix}.")], declared)


def path_around(processes: Sequence[StuckProcess]) -> str:
    """The path of the process of the ``surroundings``; empty if there is none."""
    paths = [tuple(each.path.split(".")) for each in processes]
    holders = [path[:-1] or path for path in paths]
    common = takewhile(lambda parts: len(set(parts)) == 1, zip(*holders, strict=False))
    return ".".join(part for part, *_ in common)


def definition_at(program: Program, path: Sequence[str]) -> ast.ProcessDefinition | None:
    """The definition of the process at a path that begins with the outermost one; None if it is unknown."""
    definition = program.definitions.get(path[0])
    for part in path[1:]:
        if not isinstance(definition, ast.ProcessDefinition):
            return None
        name = _INDEX.sub("", part)
        found = (instance.definition.text for instance in instances_in(definition) if instance.name.text == name)
        definition = program.definitions.get(next(found, ""))
    return definition if isinstance(definition, ast.ProcessDefinition) else None


def _marks(
    diagram: CommunicationDiagram, prefix: str, waiting: Sequence[StuckProcess], declared: Mapping[str, Span]
) -> dict[str, Mark]:
    numbers: dict[str, list[int]] = {}
    notes: dict[str, list[str]] = {}
    channels: dict[str, list[str]] = {}
    for number, each in enumerate(waiting, 1):
        note = f"{each.path} waits {each.words}"
        box = _INDEX.sub("", each.path.removeprefix(f"{prefix}.").partition(".")[0])
        numbers.setdefault(box, []).append(number)
        notes.setdefault(box, []).append(note)
        for channel in each.channels:
            if channel.startswith(f"{prefix}."):
                channels.setdefault(channel, []).append(note)
    keys = {element.key for element in diagram.elements()}
    marks = {
        key: Mark("highlighted", tuple(found) if len(found) <= MOST_NUMBERS else (), "\n".join(notes[key]))
        for key, found in numbers.items()
        if key in keys
    }
    names = {channel: channel.removeprefix(f"{prefix}.") for channel in channels}
    declaring = {channel: _declaring(diagram, declared.get(channel)) for channel in channels}
    for arrow in diagram.arrows:
        found = [
            note
            for channel, notes_on in channels.items()
            if declaring[channel] in (arrow.key, None) and may_carry(arrow, names[channel])
            for note in notes_on
        ]
        if found:
            mark = Mark("highlighted", (), "\n".join(found))
            marks[arrow.key] = mark
            marks |= {
                f"{end.element}.{end.port}": mark for end in (*arrow.sources, *arrow.sinks) if end.port is not None
            }
    for vertex in diagram.vertices:
        found = [
            note
            for channel, notes_on in channels.items()
            if _INDEX.sub("", names[channel]) == vertex.key
            for note in notes_on
        ]
        if found and vertex.key not in marks:
            marks[vertex.key] = Mark("highlighted", (), "\n".join(found))
    return marks


def _declaring(diagram: CommunicationDiagram, place: Span | None) -> str | None:
    """The key of the relationship that declares a channel at a place; None if another element does, such as a port."""
    if place is None:
        return None
    for arrow in diagram.arrows:
        around = arrow.spans[0]
        is_inside = around.file == place.file and around.start <= place.start and place.end <= around.end
        if is_inside and not arrow.by_composition:
            return arrow.key
    return None


def may_carry(arrow: Arrow, channel: str) -> bool:
    """Whether a channel may be that of an arrow: by its label, or by an end whose indexes do not contradict."""
    return any(may_be(str(name), channel) for name in (arrow.label, *arrow.sources, *arrow.sinks) if name is not None)


def may_be(written: str, name: str) -> bool:
    """Whether ``node[2 * i].y`` may be ``node[0].y``: a label is written without its indexes."""
    if _INDEX.sub("", written) != _INDEX.sub("", name):
        return False
    pairs = zip(_INDEX.findall(written), _INDEX.findall(name), strict=False)
    return all(one == other for one, other in pairs if one[1:-1].isdecimal())
