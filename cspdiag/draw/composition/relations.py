"""Places blocks side by side and below each other and draws the relations that join them. A sequence flows from left to
right and continues in a new row if it would be too long; parallel and alternative processes are below each other. A
line that ends at a group carries the circle of a parenthesis.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.base.record import record, replaced
from cspdiag.draw.annotations import BADGE, badge_width
from cspdiag.draw.composition.blocks import (
    CORNER,
    LINE,
    PARENTHESIS,
    Block,
    above,
    badges,
    centred,
    group,
    lines_of,
    look,
    parenthesis,
    placed,
    width_of,
)
from cspdiag.draw.composition.shapes import HEAD, operator_sign, warning_sign
from cspdiag.draw.composition.tooltips import chain_words
from cspdiag.draw.elements.composition import Condition, Loop, Operator
from cspdiag.draw.elements.marks import Mark
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.scene_geometry import moved
from cspdiag.draw.scene.shapes import Box, Ellipse, Group, Head, Ink, Item, Line

AHEAD = 34
"""Between two processes of a sequence."""
BELOW = 40
"""Between two processes of a vertical relation."""
_INDENT = 30
"""Of the rows of a sequence after the first."""
_ROWS = 34
"""Between two rows of a sequence, and two columns of a vertical relation."""
_TALLEST = 900
"""A vertical relation continues in a new column beyond this."""
_TURN = 18
"""The distance of the line of a loop from its body."""
_CORNER = 5
_MU = 30


@record
class _Placed:
    block: Block
    x: float
    y: float

    @property
    def entry(self) -> Point:
        return self.block.entry.moved(self.x, self.y)

    @property
    def exit(self) -> Point:
        return self.block.exit.moved(self.x, self.y)

    @property
    def right(self) -> float:
        return self.x + self.block.width

    @property
    def bottom(self) -> float:
        return self.y + self.block.height

    def above(self, x: float) -> Point:
        """Where a vertical line ends at its upper side."""
        return Point(self.x + x, self.y + self.block.top)

    def below(self, x: float) -> Point:
        """Where a vertical line begins at its lower side."""
        return Point(self.x + x, self.y + (self.block.height if self.block.bottom is None else self.block.bottom))

    def items(self) -> tuple[Item, ...]:
        return placed(self.block, self.x, self.y)


def _join(kind: str, points: Sequence[Point], first: Block, last: Block, head: Head = Head.NONE) -> Group:
    """A line between the borders of two blocks, with a circle at those that are groups."""
    shortened = [points[0], *points[1:-1], points[-1]]
    circles: list[Item] = []
    for block, end, beside in ((first, 0, 1), (last, -1, -2)):
        if block.is_group:
            dx, dy = _direction(points[end], points[beside])
            circles.append(parenthesis(points[end], dx, dy))
            shortened[end] = points[end].moved(dx * PARENTHESIS, dy * PARENTHESIS)
    line = Line(tuple(shortened), end=head, corner=_CORNER)
    return Group(kind, (line, *circles))


def _direction(start: Point, end: Point) -> tuple[float, float]:
    dx, dy = end.x - start.x, end.y - start.y
    return ((dx > 0) - (dx < 0), 0) if abs(dx) > abs(dy) else (0, (dy > 0) - (dy < 0))


def _whole(parts: Sequence[_Placed], relations: Sequence[Item], axis: float, width: float = 0) -> Block:
    width = max([width, *(part.right for part in parts)])
    height = max(part.bottom for part in parts)
    # Badges at the corners of the parts are drawn over the lines.
    items = (*relations, *(item for part in parts for item in part.items()))
    return Block(width, height, Point(0, axis), Point(width, axis), min(width / 2, 80), items)


def sequence(blocks: Sequence[Block], limit: float) -> Block:
    """Blocks from left to right with an arrow from each to the next, in rows not wider than ``limit`` if possible."""
    parts: list[_Placed] = []
    relations: list[Item] = []
    top = 0.0
    for number, row in enumerate(_rows(blocks, limit)):
        x = float(_INDENT) if number else 0.0
        axis = top + max(block.entry.y for block in row)
        for position, block in enumerate(row):
            part = _Placed(block, x, axis - block.entry.y)
            if parts:
                points = (parts[-1].exit, part.entry) if position else _return(parts, part, top)
                relations.append(_join("relation sequence", points, parts[-1].block, block, Head.OPEN_ARROW))
            parts.append(part)
            x = part.right + AHEAD + block.gap
            if position + 1 < len(row):
                x += row[position + 1].gap
        top = max(part.bottom for part in parts) + _ROWS
    extra = max((part.right for part in parts), default=0) + (
        _INDENT / 2 if top and len(_rows(blocks, limit)) > 1 else 0
    )
    return _whole(parts, relations, parts[0].entry.y, extra)


def _rows(blocks: Sequence[Block], limit: float) -> list[list[Block]]:
    rows: list[list[Block]] = []
    used = 0.0
    for block in blocks:
        if rows and used + AHEAD + block.width <= limit:
            rows[-1].append(block)
            used += AHEAD + block.width + 2 * block.gap
        else:
            used = block.width + (_INDENT if rows else 0)
            rows.append([block])
    return rows


def _return(parts: Sequence[_Placed], part: _Placed, top: float) -> tuple[Point, ...]:
    """The line from the last block of a row to the first one of the next."""
    start, end = parts[-1].exit, part.entry
    right = parts[-1].right + _INDENT / 2
    between = top - _ROWS / 2
    left = part.x - _INDENT + 5
    return (
        start,
        Point(right, start.y),
        Point(right, between),
        Point(left, between),
        Point(left, end.y),
        end,
    )


def vertical(blocks: Sequence[Block], operator: Operator, prioritized: bool) -> Block:
    """Blocks below each other, joined by a line that carries the sign of the operator; many blocks in columns."""
    if all(block.is_group and block.height > _TALLEST / 2 for block in blocks):
        return _horizontal(blocks, operator, prioritized)
    spine = min(block.spine for block in blocks)
    parts: list[_Placed] = []
    relations: list[Item] = []
    after = {number - 1: block.gap for number, block in enumerate(blocks)}
    x = y = 0.0
    for number, block in enumerate(blocks):
        if parts and y > 0 and y + block.height > _TALLEST:
            x = max(part.right for part in parts) + _ROWS + 20
            y = 0.0
        part = _Placed(block, x, y)
        if parts:
            relations.append(_vertical_relation(parts[-1], part, spine, operator, prioritized))
        parts.append(part)
        y = part.bottom + BELOW + HEAD * prioritized + block.gap + after.get(number, 0)
    if x:
        # The line to the next column passes around the upper edge.
        parts = [replaced(part, y=part.y + _TURN) for part in parts]
        relations = [moved(relation, 0, _TURN) for relation in relations]
    whole = _whole(parts, relations, 0)
    height = whole.height + (_TURN if x else 0)
    axis = height / 2
    return replaced(whole, height=height, entry=Point(0, axis), exit=Point(whole.width, axis))


def _vertical_relation(upper: _Placed, lower: _Placed, spine: float, operator: Operator, prioritized: bool) -> Group:
    start, end = upper.below(spine), lower.above(spine)
    if upper.x == lower.x:
        middle = (start.y + end.y - HEAD * prioritized + upper.block.gap - lower.block.gap) / 2
        return _relation(operator, prioritized, (start,), Point(start.x, middle), (end,), upper.block, lower.block)
    turn = lower.x - _ROWS / 2 - 2
    before = (start, Point(start.x, upper.bottom + _TURN), Point(turn, upper.bottom + _TURN))
    after = (Point(turn, lower.y - _TURN), Point(end.x, lower.y - _TURN), end)
    return _relation(operator, prioritized, before, Point(turn, lower.y + 40), after, upper.block, lower.block)


def _relation(
    operator: Operator,
    prioritized: bool,
    before: tuple[Point, ...],
    centre: Point,
    after: tuple[Point, ...],
    first: Block,
    last: Block,
) -> Group:
    """A line from one block to another with the sign of the operator at ``centre``."""
    way = _direction(before[-1], centre)
    sign, back, on = operator_sign(operator, prioritized, centre, way)
    neutral = Block(0, 0, centre, centre, 0, ())
    into, out = centre.moved(-way[0] * back, -way[1] * back), centre.moved(way[0] * on, way[1] * on)
    return Group(
        f"relation {operator}{' prioritized' if prioritized else ''}",
        (
            *_join("line", (*before, into), first, neutral).items,
            *_join("line", (out, *after), neutral, last).items,
            *sign,
        ),
        title=chain_words(operator, prioritized),
    )


def _horizontal(blocks: Sequence[Block], operator: Operator, prioritized: bool) -> Block:
    """Tall groups side by side, joined by a line through their upper parts."""
    parts: list[_Placed] = []
    relations: list[Item] = []
    y = min(80, *(block.height / 2 for block in blocks))
    x = 0.0
    for block in blocks:
        part = _Placed(block, x, 0)
        if parts:
            start, end = Point(parts[-1].right, y), Point(part.x, y)
            centre = Point((start.x + end.x - HEAD * prioritized) / 2, y)
            relations.append(_relation(operator, prioritized, (start,), centre, (end,), parts[-1].block, block))
        parts.append(part)
        x = part.right + BELOW + HEAD * prioritized + 2 * PARENTHESIS
    return _whole(parts, relations, max(part.bottom for part in parts) / 2)


def guarded(guard: Block, process: Block) -> Block:
    """A guard followed by its process."""
    axis = max(guard.entry.y, process.entry.y)
    first = _Placed(guard, 0, axis - guard.entry.y)
    second = _Placed(process, guard.width + AHEAD - 4 + process.gap, axis - process.entry.y)
    relation = _join("relation guarded", (first.exit, second.entry), guard, process, Head.OPEN_ARROW)
    whole = _whole([first, second], [relation], axis)
    return replaced(whole, spine=guard.spine, top=first.y, bottom=first.bottom)


def loop(body: Block, element: Loop, mark: Mark | None, tooltip: str) -> Block:
    """The sign of the μ-process, an arrow to its body, and a line back; the condition is written where it is tested."""
    condition = element.condition
    before = lines_of(f"while {condition.text}") if condition is not None and element.form == "while" else []
    after = lines_of(f"until {condition.text}", 300) if condition is not None and element.form == "mu" else []
    room = 0 if mark is None else badge_width(mark) + 8
    forward = max(AHEAD, width_of(before) + 27 + room if before else 0) + body.gap
    back = len(after) * LINE + 6.0
    axis = max(back + _TURN + body.entry.y, back + 12 + _MU / 2, len(before) * LINE + back + 14)
    part = _Placed(body, _MU + forward, axis - body.entry.y)
    centre = Point(_MU / 2, axis)
    sign: list[Item] = [
        Ellipse(Rectangle(0, axis - _MU / 2, _MU, _MU), Ink.PAPER, Ink.LINE, 1.2),
        *centred(["μ"], centre, size=17),
    ]
    neutral = Block(0, 0, centre, centre, 0, ())
    words_right = centre.x + 10 + (width_of(after) + room if after else 0)
    right = max(part.right + _TURN + body.gap, words_right + 10 if after else 0)
    there = _join("line", (Point(_MU, axis), part.entry), neutral, body, Head.OPEN_ARROW)
    back_points = (
        part.exit,
        Point(right, part.exit.y),
        Point(right, back),
        Point(centre.x, back),
        Point(centre.x, axis - _MU / 2),
    )
    again = _join("line", back_points, body, neutral, Head.OPEN_ARROW)
    words = _condition(condition, mark, before, Point(_MU + 8, axis)) if before else ()
    words = _condition(condition, mark, after, Point(centre.x + 10, back)) if after else words
    relation = Group("relation loop", (*sign, there, again, *words), title=tooltip)
    return _whole([part], [relation], axis, right + 1)


def _condition(condition: Condition | None, mark: Mark | None, lines: Sequence[str], at: Point) -> tuple[Item, ...]:
    """The words of a condition above a line; if marked, on a coloured background."""
    assert condition is not None
    items: list[Item] = [*above(lines, at)]
    if mark is not None:
        height, width = len(lines) * LINE, width_of(lines)
        ground = look(mark, Ink.LINE, Ink.PAPER)
        place = Rectangle(at.x - 4, at.y - 4 - height, width + 8, height + 1)
        items = [Box(place, ground.fill, ground.stroke, 3, 1.2, ground.dash), *items]
        right = place.right + badge_width(mark) + 2 + CORNER - BADGE
        items += (moved(item, 0, place.centre.y) for item in badges(mark, right))
    return (group("condition", condition.key, items, f"condition {condition.text}", mark),)


def choice(conditions: Sequence[Block], processes: Sequence[Block], otherwise: Block | None) -> Block:
    """Conditions below each other, each with its process on the right; the last may have none (``otherwise``)."""
    width = max(condition.width for condition in conditions)
    conditions = [condition.at_least(width) for condition in conditions]
    parts: list[_Placed] = []
    relations: list[Item] = []
    tests: list[_Placed] = []
    y = 0.0
    x = width + AHEAD
    for condition, process in zip(conditions, processes, strict=True):
        axis = y + max(condition.entry.y, process.entry.y)
        test = _Placed(condition, 0, axis - condition.entry.y)
        part = _Placed(process, x + process.gap, axis - process.entry.y)
        relations.append(_join("relation then", (test.exit, part.entry), condition, process, Head.OPEN_ARROW))
        if tests:
            points: tuple[Point, ...] = (Point(width / 2, tests[-1].bottom), Point(width / 2, test.y))
            relations.append(_join("relation else", points, condition, condition, Head.OPEN_ARROW))
        tests.append(test)
        parts += [test, part]
        y = max(test.bottom, part.bottom) + 24
    if otherwise is not None:
        part = _Placed(otherwise, x + otherwise.gap, y)
        points = (Point(width / 2, tests[-1].bottom), Point(width / 2, part.entry.y), part.entry)
        words = above(["else"], Point(width / 2 + 8, part.entry.y))
        line = _join("relation else", points, conditions[-1], otherwise, Head.OPEN_ARROW)
        relations.append(replaced(line, items=(*line.items, *words)))
        parts.append(part)
    return _whole(parts, relations, parts[0].entry.y)


@record
class Watch:
    """A placed handler: what it waits for, the process that then runs, and whether it handles an exception."""

    guard: Block
    process: Block
    is_exception: bool
    stroke: Ink = Ink.LINE


def watched(process: Block, watches: Sequence[Watch]) -> Block:
    """A process, and below it the handlers that can end it, the innermost first; a line from the process to each
    carries its sign.
    """
    count = len(watches)
    process = process.at_least(26 + 34 * (count - 1) + 26)
    parts = [_Placed(process, 0, 0)]
    relations: list[Item] = []
    width = max(watch.guard.width for watch in watches)
    x = 26 + 34 * (count - 1) + 30.0
    y = process.height + 34 + process.gap
    for number, watch in enumerate(watches):
        guard = watch.guard.at_least(width)
        axis = y + max(guard.entry.y, watch.process.entry.y)
        first = _Placed(guard, x, axis - guard.entry.y)
        second = _Placed(watch.process, x + width + AHEAD - 4 + watch.process.gap, axis - watch.process.entry.y)
        column = 26.0 + 34 * (count - 1 - number)
        start = Point(column, process.height)
        down = _join("line", (start, Point(column, axis), first.entry), process, guard, Head.OPEN_ARROW)
        sign = warning_sign(
            Point(column, process.height + process.gap + 18), exclaims=watch.is_exception, stroke=watch.stroke
        )
        name = "catch" if watch.is_exception else "interrupt"
        relations.append(Group(f"relation {name}", (*down.items, *sign), title=name))
        relations.append(_join("relation guarded", (first.exit, second.entry), guard, watch.process, Head.OPEN_ARROW))
        parts += [first, second]
        y = max(first.bottom, second.bottom) + 16
    return _whole(parts, relations, process.entry.y)


def equally_wide(blocks: Sequence[Block]) -> Iterator[Block]:
    """Groups as wide as the widest group, and other blocks as the widest of the others."""
    widths = {
        is_group: max((block.width for block in blocks if block.is_group is is_group), default=0)
        for is_group in (False, True)
    }
    for block in blocks:
        yield block.at_least(widths[block.is_group])
