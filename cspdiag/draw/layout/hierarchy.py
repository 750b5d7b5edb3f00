"""Which node contains which: the nodes and ports of a graph by identifier."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from cspdiag.draw.layout.graph import Edge, Graph, Node, Port


@dataclass
class Hierarchy:
    """The nodes of a graph, the node of each port, and the chain of nodes around each node, the outermost first, itself
    last.
    """

    nodes: dict[str, Node] = field(default_factory=dict)
    ports: dict[str, Port] = field(default_factory=dict)
    chains: dict[str, tuple[str, ...]] = field(default_factory=dict)
    edges: list[Edge] = field(default_factory=list)
    owners: dict[str, str] = field(default_factory=dict)
    """The node of each port, and each node for itself."""

    def room_of(self, edge: Edge) -> str | None:
        """The innermost node that holds all ends of an edge, or is one of them and holds the others; None for the whole
        graph.
        """
        ends = [self.owners[end] for end in (*edge.sources, *edge.targets)]
        common = _common([self.chains[end] for end in ends])
        if common and all(end == common[-1] for end in ends):
            # An edge that leads from a node to itself runs outside it.
            common = common[:-1]
        return common[-1] if common else None


def hierarchy(graph: Graph) -> Hierarchy:
    """The hierarchy of a graph; raises ValueError for an identifier given twice or an edge that ends nowhere."""
    found = Hierarchy(edges=list(graph.edges))
    for node, chain in _walk(graph.nodes, ()):
        _enter(found.owners, node.id, node.id)
        found.nodes[node.id], found.chains[node.id] = node, chain
        found.edges += node.edges
        for port in node.ports:
            _enter(found.owners, port.id, node.id)
            found.ports[port.id] = port
    for edge in found.edges:
        for end in (*edge.sources, *edge.targets):
            if end not in found.owners:
                raise ValueError(f"edge {edge.id!r} ends at {end!r}, which is neither a node nor a port")
        depth = 0 if (room := found.room_of(edge)) is None else len(found.chains[room])
        if any(len(found.chains[found.owners[end]]) > depth + 1 for end in (*edge.sources, *edge.targets)):
            raise ValueError(f"edge {edge.id!r} leads through the border of a node without a port")
    return found


def _walk(nodes: Sequence[Node], around: tuple[str, ...]) -> Iterator[tuple[Node, tuple[str, ...]]]:
    for node in nodes:
        chain = (*around, node.id)
        yield node, chain
        yield from _walk(node.children, chain)


def _enter(owners: dict[str, str], name: str, owner: str) -> None:
    if name in owners:
        raise ValueError(f"the identifier {name!r} is given twice")
    owners[name] = owner


def _common(chains: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    shared: list[str] = []
    for level in zip(*chains, strict=False):
        if any(name != level[0] for name in level):
            break
        shared.append(level[0])
    return tuple(shared)
