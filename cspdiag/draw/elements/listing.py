"""A communication diagram as text: its elements and their relationships, without any layout."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import assert_never

from cspdiag.draw.elements.diagram import (
    Arrow,
    Box,
    CommunicationDiagram,
    ParentPort,
    Sink,
    Store,
    Vertex,
    WrittenValue,
)
from cspdiag.model.constants.durations import duration
from cspdiag.model.sampling import Sampling


def listing(diagram: CommunicationDiagram) -> str:
    """The elements in text order, a line each; the same diagram always gives the same text."""
    return "\n".join(_lines(diagram)) + "\n"


def _lines(diagram: CommunicationDiagram) -> Iterator[str]:
    of = f" for {diagram.environment_of}" if diagram.environment_of else ""
    yield f"communication of {diagram.key}{of}{_listed(diagram.parameters)}"
    for vertex in diagram.vertices:
        yield from (f"  {line}" for line in _vertex(vertex))
    for arrow in diagram.arrows:
        yield f"  {_arrow(arrow)}"


def _vertex(vertex: Vertex) -> Iterator[str]:
    match vertex:
        case Box():
            size = f"[{vertex.size}]" if vertex.size else ""
            language = f" in {vertex.language}" if vertex.language else ""
            samples = f" every {_durations(vertex.samples)}" if vertex.samples else ""
            yield (
                f"{vertex.kind} {vertex.key}{size} : {vertex.definition}{_listed(vertex.arguments)}{language}{samples}"
            )
            for port in vertex.ports:
                default = f" = {port.default}" if port.default else ""
                state = "" if port.is_connected else ", left alone"
                yield f"  {port.direction} {port.key} : {port.type}{default}{_period(port.period, port.periods)}{state}"
            if vertex.inside is not None:
                yield from (f"  {line}" for line in _lines(vertex.inside))
        case ParentPort():
            default = f" = {vertex.default}" if vertex.default else ""
            immediate = " immediate" if vertex.immediate else ""
            safe = f" safe {vertex.safe}" if vertex.safe else ""
            period = _period(vertex.period, vertex.periods)
            type_ = f"{vertex.size or ''} : {vertex.type}"
            yield f"{vertex.direction} {vertex.key}{type_}{default}{period}{immediate}{safe}{_kinds(vertex.kinds)}"
        case Store():
            initial = f" = {vertex.initial}" if vertex.initial else ""
            requested = f" {vertex.requested}" if vertex.requested else ""
            capacity = f" {vertex.capacity}" if vertex.capacity else ""
            yield f"{vertex.form} {vertex.key} : {vertex.type}{initial}{requested}{capacity}{_kinds(vertex.kinds)}"
        case WrittenValue():
            yield f"value {vertex.text}"
        case Sink():
            yield f"sink of {vertex.key}"
        case _:
            assert_never(vertex)


def _arrow(arrow: Arrow) -> str:
    label = f" {arrow.label}" if arrow.label else ""
    type_ = f" : {arrow.type}" if arrow.type else ""
    capacity = f" {arrow.capacity}" if arrow.capacity else ""
    repeated = "".join(f" for {replicator}" for replicator in arrow.repeated)
    requested = f" {arrow.requested}{capacity}" if arrow.requested else ""
    through = f"{label}{type_}{requested}{_kinds(arrow.kinds)}"
    sign = "~>" if arrow.by_composition else "->"
    middle = f" {sign}{through} {sign} " if through else f" {sign} "
    return f"{', '.join(map(str, arrow.sources))}{middle}{', '.join(map(str, arrow.sinks))}{repeated}"


def _kinds(kinds: Iterable[str]) -> str:
    found = ", ".join(kinds)
    return f" ({found})" if found else ""


def _period(written: str | None, periods: tuple[Sampling, ...]) -> str:
    if written is None:
        return ""
    values = ", ".join(map(str, periods))
    return f" @ {written}" + (f" ({values})" if values and values != written else "")


def _durations(periods: Iterable[int]) -> str:
    return ", ".join(duration(period) for period in periods)


def _listed(items: Iterable[str]) -> str:
    found = ", ".join(items)
    return f"({found})" if found else ""
