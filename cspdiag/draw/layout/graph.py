"""The graph to be laid out, and the resulting layout.

The records know sizes, not looks: the builder of a graph has measured its texts. Identifiers are unique in the whole
graph, ports and labels included. Lengths are in pixels, places are absolute.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum

from cspdiag.base.errors import CspdiagError
from cspdiag.base.record import EMPTY, record
from cspdiag.draw.scene.geometry import Point, Rectangle


class Side(Enum):
    """A side of a box."""

    NORTH = "NORTH"
    EAST = "EAST"
    SOUTH = "SOUTH"
    WEST = "WEST"


class PortOrder(Enum):
    """The freedom of the layout in placing the ports of a node."""

    FREE = "FREE"
    """Any side, any order."""
    FIXED_SIDE = "FIXED_SIDE"
    """The side that each port names, in any order."""
    FIXED_ORDER = "FIXED_ORDER"
    """The side that each port names, in the order of the node's ports: downwards, and to the right."""


class Layer(Enum):
    """The place of a node along the direction of the drawing."""

    ANY = "NONE"
    FIRST = "FIRST"
    LAST = "LAST"


class Direction(Enum):
    """Where most edges lead."""

    RIGHT = "RIGHT"
    DOWN = "DOWN"


@record
class Label:
    """A text of known size that gets room of its own."""

    id: str
    width: float
    height: float


@record
class Port:
    """A place at the border of a node where edges end; its label is inside the node, next to it.

    ``side`` is None if the layout is free to choose (``PortOrder.FREE``).
    """

    id: str
    side: Side | None = None
    label: Label | None = None


@record
class Padding:
    """The room between the border of a node and its children."""

    top: float = 12
    right: float = 12
    bottom: float = 12
    left: float = 12


@record
class Node:
    """A box of at least ``width`` and ``height``; it grows for its ports, their labels, its title and its children.

    ``title`` gets a row of its own at the top, above children and ports. Children are laid out among themselves: an
    edge leads from one of them to another, or to a port of the node around them.
    """

    id: str
    width: float = 0
    height: float = 0
    title: Label | None = None
    ports: tuple[Port, ...] = ()
    port_order: PortOrder = PortOrder.FIXED_SIDE
    children: tuple[Node, ...] = ()
    edges: tuple[Edge, ...] = ()
    padding: Padding = Padding()
    layer: Layer = Layer.ANY


@record
class Edge:
    """A line from ports or nodes to others, by their identifiers; several at an end make a joined line.

    Its label is next to the line, before it forks if there are several targets, and never on it.
    """

    id: str
    sources: tuple[str, ...]
    targets: tuple[str, ...]
    label: Label | None = None
    priority: int = 0
    """Edges of a higher priority are kept shorter and straighter."""


@record
class Graph:
    """Nodes and edges to be placed; the order in which they are given is kept where that costs little."""

    nodes: tuple[Node, ...]
    edges: tuple[Edge, ...] = ()
    direction: Direction = Direction.RIGHT
    node_spacing: float = 28
    """Between boxes next to each other."""
    layer_spacing: float = 44
    """Between boxes one after the other."""


@record
class Section:
    """A part of an edge without forks: a line through ``points``, at right angles.

    ``source`` and ``target`` name the port or node at its ends, None if it meets other sections of the same edge there.
    An arrow head belongs to the end of a section that has a target.
    """

    points: tuple[Point, ...]
    source: str | None
    target: str | None


@record
class Route:
    """Where an edge runs. Sections from one port may share their first part; ``junctions`` are where they fork
    or join.
    """

    sections: tuple[Section, ...]
    junctions: tuple[Point, ...] = ()


@record
class Layout:
    """Absolute places by identifier; the drawing reaches from (0, 0) to ``width`` and ``height``."""

    width: float
    height: float
    nodes: Mapping[str, Rectangle]
    ports: Mapping[str, Point] = EMPTY
    """The points on the border where edges end."""
    sides: Mapping[str, Side] = EMPTY
    """The sides of their nodes at which the ports were placed."""
    labels: Mapping[str, Rectangle] = EMPTY
    routes: Mapping[str, Route] = EMPTY


class LayoutError(CspdiagError):
    """There is no engine to lay out with, or it failed; the message is one sentence for the user, with a remedy."""
