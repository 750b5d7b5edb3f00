"""The size of a box that its title and its ports need, and the places of their labels in it."""

from __future__ import annotations

from collections.abc import Iterable
from math import ceil

from cspdiag.draw.layout.graph import Node, Padding, Port, Side
from cspdiag.draw.scene.geometry import Point, Rectangle

BORDER_GAP = 8.0
"""Between the border of a box and its contents."""
COLUMN_GAP = 18.0
"""Between the labels of ports on opposite sides."""
PORT_SPACING = 24.0
"""Between ports on one side."""
SIGN_ROOM = 24.0
"""At the beginning of a line, for a sign of what it is."""
TITLE_GAP = 7.0
"""Above and below a title."""


def even(length: float) -> float:
    """The next even number of pixels: halves of it are whole, so that lines between middles are straight."""
    return 2.0 * ceil(length / 2)


def title_height(node: Node) -> float:
    """The height of the row that the title has, 0 without one."""
    return even(node.title.height + 2 * TITLE_GAP) if node.title else 0


def _widest(ports: Iterable[Port], side: Side) -> float:
    return max((port.label.width for port in ports if port.side is side and port.label), default=0)


def least_size(node: Node) -> tuple[float, float]:
    """The least width and height with which a box without children shows its title and the labels of its ports. The
    room that the ports themselves need along their sides is not included.
    """
    west, east = _widest(node.ports, Side.WEST), _widest(node.ports, Side.EAST)
    free = max((port.label.width for port in node.ports if port.side is None and port.label), default=0)
    west, east = max(west, free), max(east, free)
    labels = west + east + 2 * BORDER_GAP + (COLUMN_GAP if west and east else 0) if west or east else 0
    title = node.title.width + 2 * BORDER_GAP if node.title else 0
    return even(max(node.width, labels, title)), even(max(node.height, title_height(node)))


def children_padding(node: Node) -> Padding:
    """The room around the children of a node, its title and the labels of its ports included."""
    padding = node.padding
    west, east = (_widest(node.ports, side) for side in (Side.WEST, Side.EAST))
    return Padding(
        padding.top + title_height(node),
        max(padding.right, even(east + BORDER_GAP + SIGN_ROOM) if east else 0),
        padding.bottom,
        max(padding.left, even(west + BORDER_GAP) if west else 0),
    )


def port_spacing(node: Node) -> float:
    """The least distance of the ports of a side: labels that are side by side have to fit."""
    across = [port.label.width for port in node.ports if port.label and port.side in {Side.NORTH, Side.SOUTH}]
    return max([PORT_SPACING, *(width + BORDER_GAP for width in across)])


def title_place(node: Node, place: Rectangle) -> Rectangle | None:
    """The place of the title of a placed node: at the top, centred."""
    if node.title is None:
        return None
    title = node.title
    return Rectangle(place.centre.x - title.width / 2, place.y + TITLE_GAP, title.width, title.height)


def port_label_place(node: Node, port: Port, at: Point, side: Side) -> Rectangle | None:
    """The place of the label of a placed port: inside, next to the port; above the line that enters, if the node has
    children.
    """
    if port.label is None:
        return None
    width, height = port.label.width, port.label.height
    y = at.y - height - 2 if node.children else at.y - height / 2
    match side:
        case Side.WEST:
            return Rectangle(at.x + BORDER_GAP, y, width, height)
        case Side.EAST:
            return Rectangle(at.x - BORDER_GAP - width, y, width, height)
        case Side.NORTH:
            return Rectangle(at.x - width / 2, at.y + BORDER_GAP, width, height)
        case Side.SOUTH:
            return Rectangle(at.x - width / 2, at.y - BORDER_GAP - height, width, height)
