"""Finds what was renamed, if that is obvious: nothing else of its sort could have become it."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from typing import TypeVar, assert_never

from cspdiag.base.record import replaced
from cspdiag.draw.elements.diagram import (
    Arrow,
    Box,
    CommunicationDiagram,
    End,
    ParentPort,
    Sink,
    Store,
    Vertex,
    WrittenValue,
)

T = TypeVar("T")


def pairs(removed: Iterable[T], added: Iterable[T], signature: Callable[[T], Hashable]) -> list[tuple[T, T]]:
    """Pairs of a removed and an added item with a signature that no other removed or added item has."""
    by_signature: dict[Hashable, tuple[list[T], list[T]]] = {}
    for position, items in enumerate((removed, added)):
        for item in items:
            by_signature.setdefault(signature(item), ([], []))[position].append(item)
    return [(old[0], new[0]) for old, new in by_signature.values() if len(old) == len(new) == 1]


def vertex_renames(before: CommunicationDiagram, after: CommunicationDiagram) -> dict[str, str]:
    """The new names of elements: equal in everything, and connected mostly to the same ends, or not at all."""
    kept = {vertex.key for vertex in before.vertices} & {vertex.key for vertex in after.vertices}
    removed = [
        vertex for vertex in before.vertices if vertex.key not in kept and not isinstance(vertex, Sink | WrittenValue)
    ]
    added = [
        vertex for vertex in after.vertices if vertex.key not in kept and not isinstance(vertex, Sink | WrittenValue)
    ]
    surroundings = {id(vertex): _surroundings(before, vertex.key, kept) for vertex in removed}
    surroundings |= {id(vertex): _surroundings(after, vertex.key, kept) for vertex in added}
    return {
        old.key: new.key
        for old, new in pairs(removed, added, _signature)
        if _alike(surroundings[id(old)], surroundings[id(new)])
    }


def _alike(one: frozenset[tuple[str, str]], other: frozenset[tuple[str, str]]) -> bool:
    return len(one & other) * 2 >= len(one | other)


def _signature(vertex: Vertex) -> Hashable:
    match vertex:
        case Box():
            return (vertex.kind, vertex.definition, vertex.arguments, vertex.size)
        case ParentPort():
            return (vertex.direction, vertex.type, vertex.size, vertex.period, vertex.default, vertex.safe)
        case Store():
            return (vertex.form, vertex.type, vertex.initial, vertex.requested, vertex.capacity)
        case WrittenValue() | Sink():
            return vertex.key
        case _:
            assert_never(vertex)


def _surroundings(diagram: CommunicationDiagram, key: str, kept: set[str]) -> frozenset[tuple[str, str]]:
    """The ends to which an element is connected, as far as they have kept their names, and the ports of its own through
    which it is.
    """
    found: set[tuple[str, str]] = set()
    for arrow in diagram.arrows:
        ends = (*arrow.sources, *arrow.sinks)
        own = [end.port or "" for end in ends if end.element == key]
        found.update((port, str(end)) for port in own for end in ends if end.element in kept)
    return frozenset(found)


def renamed(
    diagram: CommunicationDiagram, names: Mapping[str, str], definitions: Mapping[str, str]
) -> CommunicationDiagram:
    """The diagram with new names of elements and of definitions of instances."""

    def end(old: End) -> End:
        return End(names.get(old.element, old.element), old.port)

    arrows = []
    for arrow in diagram.arrows:
        new = replaced(arrow, sources=tuple(map(end, arrow.sources)), sinks=tuple(map(end, arrow.sinks)))
        arrows.append(replaced(new, key=_key(arrow, new)))
    vertices: list[Vertex] = []
    for vertex in diagram.vertices:
        key = names.get(vertex.key, vertex.key)
        if isinstance(vertex, Box):
            vertices.append(replaced(vertex, key=key, definition=definitions.get(vertex.definition, vertex.definition)))
        else:
            vertices.append(replaced(vertex, key=key))
    return replaced(diagram, vertices=tuple(vertices), arrows=tuple(arrows))


def _key(before: Arrow, after: Arrow) -> str:
    """The new key of an arrow; a key that is made of its ends follows their names."""
    if before.label is not None:
        return before.key
    for old, new in zip((*before.sources, *before.sinks), (*after.sources, *after.sinks), strict=True):
        if old != new:
            sign = "~>" if after.by_composition else "->"
            return f"{', '.join(map(str, after.sources))} {sign} {', '.join(map(str, after.sinks))}"
    return before.key


def with_matched_arrows(before: CommunicationDiagram, after: CommunicationDiagram) -> CommunicationDiagram:
    """The earlier diagram, in which relationships that share an end with exactly one new one have its key: they are
    changed, not replaced.
    """
    kept = {arrow.key for arrow in before.arrows} & {arrow.key for arrow in after.arrows}
    removed = [arrow for arrow in before.arrows if arrow.key not in kept and not arrow.by_composition]
    added = [arrow for arrow in after.arrows if arrow.key not in kept and not arrow.by_composition]
    keys: dict[str, str] = {}
    for arrow in removed:
        alike = [other for other in added if _shares_an_end(arrow, other)]
        if len(alike) == 1 and sum(_shares_an_end(each, alike[0]) for each in removed) == 1:
            keys[arrow.key] = alike[0].key
    return replaced(
        before, arrows=tuple(replaced(arrow, key=keys.get(arrow.key, arrow.key)) for arrow in before.arrows)
    )


def _shares_an_end(one: Arrow, other: Arrow) -> bool:
    return bool({*one.sources} & {*other.sources} or {*one.sinks} & {*other.sinks})
