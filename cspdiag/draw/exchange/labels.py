"""The labels of the nodes and edges of a graph, the same in every format."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import networkx

from cspdiag.model.sampling import Sampling

Facts = Mapping[str, object]


def node_lines(facts: Facts) -> tuple[str, ...]:
    """The lines at a node: its name with its definition; for a port, its type and period."""
    if facts["kind"] == "port":
        return str(facts["name"]), _type_and_period(facts)
    if facts["name"] == facts["definition"]:
        return (str(facts["name"]),)
    return (f"{facts['name']}: {facts['definition']}",)


def edge_lines(facts: Facts) -> tuple[str, ...]:
    """The lines at an edge: the channel, its kind with the capacity, its type with the period."""
    capacity = "" if facts["capacity"] is None else f" {facts['capacity']}"
    return str(facts["name"]), f"{facts['kind']}{capacity}", _type_and_period(facts)


def _type_and_period(facts: Facts) -> str:
    period, offset = facts["period"], facts.get("offset", 0)
    if not isinstance(period, int) or not isinstance(offset, int):
        return str(facts["type"])
    return f"{facts['type']} @ {Sampling(period, offset)}"


class Enter:
    """What follows, up to its ``Leave``, is inside this node; ``number`` is that of the node."""

    def __init__(self, number: int, facts: Facts) -> None:
        self.number = number
        self.facts = facts


class Leave:
    """The end of what is inside a node."""


class Single:
    """A node by itself, or the communications of a process itself that has others inside."""

    def __init__(self, number: int, facts: Facts) -> None:
        self.number = number
        self.facts = facts


def nested(graph: networkx.MultiDiGraph) -> Iterator[Enter | Single | Leave]:
    """The nodes in their nesting. A process that has others inside is a node itself only if an edge begins or ends at
    it.
    """
    inside: dict[object, list[tuple[int, str]]] = {}
    for number, (path, parent) in enumerate(graph.nodes(data="parent")):
        inside.setdefault(parent, []).append((number, path))
    pending: list[tuple[int, str] | None] = [*reversed(inside.get(None, []))]
    while pending:
        following = pending.pop()
        if following is None:
            yield Leave()
            continue
        number, path = following
        facts = graph.nodes[path]
        if path not in inside:
            yield Single(number, facts)
            continue
        yield Enter(number, facts)
        if graph.degree(path):
            yield Single(number, facts)
        pending += [None, *reversed(inside[path])]
