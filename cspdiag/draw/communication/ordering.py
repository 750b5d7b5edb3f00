"""The order in which elements are passed to the layout, which keeps it within a layer."""

from __future__ import annotations

from cspdiag.draw.elements.diagram import Box, CommunicationDiagram, End, Vertex


def ordered(diagram: CommunicationDiagram) -> list[Vertex]:
    """Instances in text order, and everything else next to the ports to which it is connected. Box number ``n`` has
    position ``n``, with its ports around that. An element with one neighbour is next to its port, one with several at
    their mean position, neighbours of boxes first. What is connected to no box comes last.
    """
    positions = _box_positions(diagram)
    neighbours: dict[str, list[End]] = {vertex.key: [] for vertex in diagram.vertices}
    for arrow in diagram.arrows:
        for ends, others in ((arrow.sources, arrow.sinks), (arrow.sinks, arrow.sources)):
            for end in ends:
                neighbours.setdefault(end.element, []).extend(others)
    boxes = {box.key for box in diagram.boxes}
    pending = [vertex.key for vertex in diagram.vertices if vertex.key not in boxes]
    while pending:
        found = {key: mean for key in pending if (mean := _mean(positions, neighbours[key])) is not None}
        if not found:
            break
        positions.update(found)
        pending = [key for key in pending if key not in found]
    last = float(len(boxes))
    return sorted(diagram.vertices, key=lambda vertex: positions.get(vertex.key, last))


def _box_positions(diagram: CommunicationDiagram) -> dict[str, float]:
    positions: dict[str, float] = {}
    for number, box in enumerate(diagram.boxes):
        positions[box.key] = number
        for direction in ("in", "out"):
            ports = [port.key for port in box.ports if port.direction == direction]
            for place, key in enumerate(ports):
                positions[_port(box, key)] = number + (place + 0.5) / len(ports) - 0.5
    return positions


def _port(box: Box, key: str) -> str:
    return f"{box.key}|{key}"


def _mean(positions: dict[str, float], ends: list[End]) -> float | None:
    if len({end.element for end in ends}) > 1:
        ends = [End(end.element) for end in ends]
    known = [place for end in ends if (place := _position(positions, end)) is not None]
    return sum(known) / len(known) if known else None


def _position(positions: dict[str, float], end: End) -> float | None:
    if end.port is not None and f"{end.element}|{end.port}" in positions:
        return positions[f"{end.element}|{end.port}"]
    return positions.get(end.element)
