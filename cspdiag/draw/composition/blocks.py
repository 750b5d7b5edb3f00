"""Blocks: parts of a composition diagram that are placed as a unit, and the frames around those with parts of their
own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from cspdiag.base.record import record
from cspdiag.draw.annotations import BADGE, badge, badge_width
from cspdiag.draw.communication.symbols import STACK, inside, outline
from cspdiag.draw.elements.marks import Mark
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.scene_geometry import moved
from cspdiag.draw.scene.shapes import Anchor, Box, Dash, Ellipse, Face, Group, Ink, Item, Text, TextRun
from cspdiag.draw.scene.text_metrics import CAPITAL, text_width

SIZE = 13
"""The size of texts, in pixels."""
LINE = 16
"""From one line of a text to the next."""
PARENTHESIS = 7
"""The diameter of the small circle at the end of a line that belongs to a group."""
CORNER = 4
"""From the corner of an element to the middle of its badge, if the badge is no wider than high."""
PADDING = 14
"""Between a frame and what it holds."""
LONGEST = 220
"""The width of a line of text above which it is broken."""
MOST_LINES = 4
"""The number of lines of a text; a longer one ends in an ellipsis, and its tooltip has all of it."""


@record
class Block:
    """Items in a room that begins at (0, 0).

    Lines of a sequence end at ``entry`` on the left and begin at ``exit`` on the right; vertical lines meet the upper
    and the lower side at ``spine`` or further to the left, at the heights ``top`` and ``bottom`` (None: the sides of
    the room). ``is_group``: lines at its border end in the circle of a parenthesis. ``widened`` makes the same block at
    least this wide.
    """

    width: float
    height: float
    entry: Point
    exit: Point
    spine: float
    items: tuple[Item, ...]
    is_group: bool = False
    top: float = 0
    bottom: float | None = None
    widened: Callable[[float], Block] | None = None

    @property
    def gap(self) -> float:
        """The room for the circle at the end of a line."""
        return PARENTHESIS if self.is_group else 0

    def at_least(self, width: float) -> Block:
        """The same block, widened if it can be."""
        return self if self.widened is None or self.width >= width else self.widened(width)


def placed(block: Block, x: float, y: float) -> tuple[Item, ...]:
    """The items of a block at a place."""
    return tuple(moved(item, x, y) for item in block.items)


@record
class Look:
    """How an element is outlined and filled."""

    stroke: Ink
    fill: Ink
    width: float = 1.2
    dash: Dash = Dash.SOLID


def look(mark: Mark | None, stroke: Ink, fill: Ink) -> Look:
    """The look of an element with its mark, or without one."""
    ink, width, dash = outline(mark, stroke)
    return Look(ink, inside(mark, fill), width, dash)


def badges(mark: Mark | None, right: float) -> tuple[Item, ...]:
    """The badge at the upper right corner of an element, with the numbers of its messages or the sign of a change, if
    its mark has any.
    """
    if mark is None or not (mark.numbers or mark.note):
        return ()
    # A wide badge extends to the left, over the element: to the right there are lines.
    return (badge(mark, Point(right + BADGE - CORNER - badge_width(mark) / 2, 0)),)


def group(kind: str, key: str, items: Iterable[Item], title: str, mark: Mark | None, link: str = "") -> Group:
    """The group of the items of one element, with its mark in its classes and its tooltip."""
    words = kind if mark is None else f"{kind} {mark.kind}"
    notes = (title, mark.note if mark is not None else "")
    return Group(words, tuple(items), f"step-{key}", "\n".join(note for note in notes if note), link)


def lines_of(text: str, longest: float = LONGEST, face: Face = Face.SANS) -> list[str]:
    """A text in lines not longer than ``longest``, as far as its spaces allow."""
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if lines[-1] and text_width(longer, SIZE, face) > longest:
            lines.append(word)
        else:
            lines[-1] = longer
    if len(lines) > MOST_LINES:
        lines = [*lines[: MOST_LINES - 1], f"{lines[MOST_LINES - 1]} …"]
    return lines


def width_of(lines: Sequence[str], face: Face = Face.SANS, size: float = SIZE) -> float:
    """The width of the longest line."""
    return max(text_width(line, size, face) for line in lines)


def centred(
    lines: Sequence[str], centre: Point, face: Face = Face.SANS, ink: Ink = Ink.TEXT, size: float = SIZE
) -> list[Text]:
    """Lines of text around a point."""
    first = centre.y - (len(lines) - 1) * LINE / 2 + CAPITAL / 2 * size
    return [
        Text(Point(centre.x, first + number * LINE), (TextRun(line, face, ink),), size, Anchor.MIDDLE)
        for number, line in enumerate(lines)
    ]


def above(lines: Sequence[str], at: Point, face: Face = Face.SANS, anchor: Anchor = Anchor.START) -> list[Text]:
    """Lines of text above a line."""
    first = at.y - 6 - (len(lines) - 1) * LINE
    return [
        Text(Point(at.x, first + number * LINE), (TextRun(line, face),), SIZE, anchor)
        for number, line in enumerate(lines)
    ]


def parenthesis(at: Point, dx: float, dy: float) -> Ellipse:
    """The small circle that touches a border at a point, on the side to which (dx, dy) leads."""
    radius = PARENTHESIS / 2
    centre = at.moved(dx * radius, dy * radius)
    return Ellipse(Rectangle(centre.x - radius, centre.y - radius, PARENTHESIS, PARENTHESIS), Ink.PAPER, Ink.LINE)


@record
class FrameStyle:
    """The attributes of a frame: its class, its key, its tooltip, and the name in its upper left corner."""

    kind: str
    key: str
    title: str = ""
    mark: Mark | None = None
    name: tuple[Item, ...] = ()
    name_width: float = 0
    name_height: float = 22
    copies: int = 1


def framed(block: Block, style: FrameStyle) -> Block:
    """A block within a frame, which other blocks can be joined to as to a single process."""
    top = PADDING + (style.name_height if style.name else 0)
    behind = STACK * (style.copies - 1)
    inner_width = max(block.width + 2 * PADDING, style.name_width + 2 * PADDING)
    height = block.height + top + PADDING
    shown = look(style.mark, Ink.FAINT, Ink.FRAME)

    def frame(wanted: float) -> Block:
        width = max(inner_width, wanted - behind)
        boxes = [
            Box(
                Rectangle(STACK * copy, STACK * copy, width, height),
                shown.fill,
                shown.stroke,
                8,
                shown.width,
                shown.dash,
            )
            for copy in reversed(range(style.copies))
        ]
        title = tuple(moved(item, 12, 20) for item in style.name)
        items = (*boxes, *title, *placed(block, PADDING, top), *badges(style.mark, width))
        axis = top + block.entry.y
        return Block(
            width + behind,
            height + behind,
            Point(0, axis),
            Point(width + behind, axis),
            min(width / 2, 80),
            (group(style.kind, style.key, items, style.title, style.mark),),
            is_group=True,
            widened=frame,
        )

    return frame(0)
