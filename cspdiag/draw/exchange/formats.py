"""Graphs of networks as text: DOT of Graphviz, flowcharts of Mermaid, GraphML."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import assert_never

import networkx

from cspdiag.base.render.snippet import on_one_line
from cspdiag.draw.exchange import FORMATS
from cspdiag.draw.exchange.labels import Enter, Leave, Single, edge_lines, nested, node_lines


def graph_text(graph: networkx.MultiDiGraph, format_: str) -> str:
    """A graph as text in one of ``FORMATS``. Raises ValueError for another one."""
    match format_:
        case "dot":
            return "\n".join(_dot(graph)) + "\n"
        case "mermaid":
            return "\n".join(_mermaid(graph)) + "\n"
        case "graphml":
            return _graphml(graph)
        case _:
            raise ValueError(f"a graph is {', '.join(FORMATS)}, not {format_!r}")


_DOT_SHAPES = {
    "process": "box",
    "submodel": "box, style=rounded",
    "port": "plaintext",
    "environment": "box, style=dashed",
    "driver": "box, style=dashed",
}


def _dot(graph: networkx.MultiDiGraph) -> Iterator[str]:
    yield f"digraph {_dot_string([graph.graph['name']])} {{"
    yield "  rankdir=LR;"
    yield "  node [fontname=sans];"
    yield "  edge [fontname=sans, fontsize=10];"
    depth = 1
    for part in nested(graph):
        match part:
            case Enter():
                yield f"{'  ' * depth}subgraph cluster_{part.number} {{"
                depth += 1
                yield f"{'  ' * depth}label={_dot_string(node_lines(part.facts))};"
            case Single():
                facts = part.facts
                place = _dot_string([f"{facts['path']}, {facts['file']}:{facts['line']}"])
                shown = f"label={_dot_string(node_lines(facts))}, tooltip={place}"
                yield f"{'  ' * depth}n{part.number} [{shown}, shape={_DOT_SHAPES[str(facts['kind'])]}];"
            case Leave():
                depth -= 1
                yield f"{'  ' * depth}}}"
            case _:
                assert_never(part)
    for source, target, facts in _edges(graph):
        place = _dot_string([f"{facts['channel']}: {facts['source_port']} to {facts['target_port']}"])
        yield f"  n{source} -> n{target} [label={_dot_string(edge_lines(facts))}, tooltip={place}];"
    yield "}"


def _dot_string(lines: Iterable[object]) -> str:
    """A quoted string of DOT. Graphviz reads escapes and, as in HTML, entities in it."""
    escaped = (on_one_line(line).replace("&", "&amp;").replace("\\", "\\\\").replace('"', '\\"') for line in lines)
    return '"' + "\\n".join(escaped) + '"'


_MERMAID_SHAPES = {
    "process": "[{}]",
    "submodel": "({})",
    "port": "([{}])",
    "environment": "[[{}]]",
    "driver": "[[{}]]",
}


def _mermaid(graph: networkx.MultiDiGraph) -> Iterator[str]:
    yield "flowchart LR"
    depth = 1
    for part in nested(graph):
        match part:
            case Enter():
                yield f"{'  ' * depth}subgraph s{part.number}[{_mermaid_string(node_lines(part.facts))}]"
                depth += 1
            case Single():
                shape = _MERMAID_SHAPES[str(part.facts["kind"])]
                yield f"{'  ' * depth}n{part.number}{shape.format(_mermaid_string(node_lines(part.facts)))}"
            case Leave():
                depth -= 1
                yield f"{'  ' * depth}end"
            case _:
                assert_never(part)
    for source, target, facts in _edges(graph):
        yield f"  n{source} -->|{_mermaid_string(edge_lines(facts))}| n{target}"


_MERMAID_PLAIN = re.compile(r"[^\w .,:@()\[\]/-]")


def _mermaid_string(lines: Iterable[object]) -> str:
    """A quoted string of Mermaid; quotes, tags and Markdown are written as the numbers of their characters."""
    escaped = (_MERMAID_PLAIN.sub(lambda found: f"#{ord(found[0])};", on_one_line(line)) for line in lines)
    return '"' + "<br/>".join(escaped) + '"'


def _edges(graph: networkx.MultiDiGraph) -> Iterator[tuple[int, int, Mapping[str, object]]]:
    """The edges in their order, by the numbers of the nodes."""
    number = {path: at for at, path in enumerate(graph)}
    for source, target, _, facts in sorted(graph.edges(keys=True, data=True), key=lambda edge: edge[2]):
        yield number[source], number[target], facts


def _graphml(graph: networkx.MultiDiGraph) -> str:
    plain = networkx.MultiDiGraph(**_graphml_data(graph.graph))
    plain.add_nodes_from((path, _graphml_data(facts)) for path, facts in graph.nodes(data=True))
    plain.add_edges_from(
        (source, target, key, _graphml_data(facts)) for source, target, key, facts in graph.edges(keys=True, data=True)
    )
    written = io.BytesIO()
    networkx.write_graphml_xml(plain, written)
    return written.getvalue().decode("utf-8") + "\n"


def _graphml_data(facts: Mapping[str, object]) -> dict[str, str | int]:
    """Attributes that GraphML can have: no empty ones, and texts of characters that XML has."""
    data: dict[str, str | int] = {}
    for name, value in facts.items():
        if isinstance(value, int):
            data[name] = value
        elif isinstance(value, Mapping):
            if value:
                data[name] = on_one_line(", ".join(f"{key} = {inner}" for key, inner in value.items()))
        elif value is not None:
            data[name] = on_one_line(value)
    return data
