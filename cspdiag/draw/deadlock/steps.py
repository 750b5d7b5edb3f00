"""Finds the steps of their compositions at which processes wait."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import PurePath

from cspdiag.base import Span
from cspdiag.draw.deadlock.marks import MOST_NUMBERS, StuckProcess, definition_at, may_be
from cspdiag.draw.elements.composition import Activity, CompositionDiagram, Guard, Part
from cspdiag.draw.elements.marks import Mark
from cspdiag.draw.elements.read_composition import composition_diagram
from cspdiag.model.program import Program


def waiting_steps(
    program: Program, waiting: Sequence[StuckProcess]
) -> list[tuple[CompositionDiagram, dict[str, Mark]]]:
    """The compositions of the waiting processes, each once, with marks where they wait, numbered in their order.

    A process gets no mark if it is not certain at which step it waits.
    """
    diagrams: dict[str, CompositionDiagram] = {}
    found: dict[str, dict[str, list[int]]] = {}
    for number, each in enumerate(waiting, 1):
        definition = definition_at(program, each.path.split("."))
        if definition is None or definition.composition is None:
            continue
        name = definition.name.text
        if name not in diagrams:
            diagrams[name] = composition_diagram(program.definitions, definition)
        for key in _steps(diagrams[name], each):
            found.setdefault(name, {}).setdefault(key, []).append(number)
    return [
        (
            diagrams[name],
            {
                key: Mark("highlighted", tuple(numbers) if len(numbers) <= MOST_NUMBERS else ())
                for key, numbers in steps.items()
            },
        )
        for name, steps in found.items()
    ]


def steps_beside(diagram: CompositionDiagram, path: str, processes: Sequence[StuckProcess]) -> list[str]:
    """The keys of the elements of a composition, that of the process at a path, which concern some processes: what runs
    them, or the instance that they are in; for the process itself, the smallest element at which it is.
    """
    found: dict[str, None] = {}
    for each in processes:
        if each.path == path:
            found |= dict.fromkeys([] if each.span is None else _at(diagram, each.span))
        elif each.path.startswith(f"{path}."):
            instance = each.path.removeprefix(f"{path}.").partition(".")[0]
            found |= {
                element.key: None
                for element in diagram.elements()
                if isinstance(element, Activity) and element.form == "run" and may_be(element.text, instance)
            }
    return list(found)


def _steps(diagram: CompositionDiagram, waiting: StuckProcess) -> list[str]:
    """The elements at which a process waits; for an alternative, its guards."""
    if waiting.span is not None:
        return _at(diagram, waiting.span)
    steps = list(_on_line(diagram, waiting))
    kinds = {type(step) for step in steps}
    alternative = len(waiting.channels) > 1 and kinds == {Guard}
    return [step.key for step in steps] if len(steps) == 1 or alternative else []


def _at(diagram: CompositionDiagram, span: Span) -> list[str]:
    """The smallest element that contains the place."""
    around = [
        (place.end - place.start, element.key)
        for element in diagram.elements()
        for place in element.spans
        if place.file == span.file and place.start <= span.start and span.end <= place.end
    ]
    return [min(around)[1]] if around else []


def _on_line(diagram: CompositionDiagram, waiting: StuckProcess) -> Iterator[Part]:
    """The steps on the line of the place that do what the process waits for; if it waits for several channels, the
    guards.
    """
    file, _, line = (waiting.place or "").rpartition(":")
    sort = Guard if len(waiting.channels) > 1 else Activity
    ports = {port.partition("[")[0] for port in waiting.ports}
    for element in diagram.elements():
        if not isinstance(element, sort) or not element.spans:
            continue
        span = element.spans[0]
        is_there = str(span.line) == line and PurePath(span.file).name == PurePath(file).name
        if is_there and (not ports or re.split(r"\W", element.text)[0] in ports):
            yield element
