"""Explains the signs that occur in a composition diagram."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.draw.communication.legend import ROW, SAMPLE, Entry
from cspdiag.draw.composition.blocks import centred, parenthesis
from cspdiag.draw.composition.shapes import operator_sign, warning_sign
from cspdiag.draw.elements.composition import (
    Activity,
    Case,
    Chain,
    CompositionDiagram,
    Guard,
    Guarded,
    Handler,
    Inside,
    Loop,
    NamedGroup,
    Operator,
    Replication,
    parts,
)
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.shapes import Box, Ellipse, Ink, Line

_OPERATORS: dict[tuple[Operator, bool], str] = {
    ("parallel", False): "parallel",
    ("parallel", True): "parallel, priority to the first",
    ("alternative", False): "alternative",
    ("alternative", True): "alternative, priority to the first",
}
_MIDDLE = Point(SAMPLE / 2, ROW / 2)


def explanations(diagram: CompositionDiagram) -> Iterator[Entry]:
    """The entries of the legend, always in the same order; a sequence is shown by its arrows."""
    elements = list(diagram.elements())
    operators = {(each.operator, each.prioritized) for each in elements if isinstance(each, Chain | Replication)}
    for (operator, prioritized), words in _OPERATORS.items():
        if (operator, prioritized) in operators:
            sign, back, on = operator_sign(operator, prioritized, _MIDDLE, (1, 0))
            before = Line((Point(2, _MIDDLE.y), _MIDDLE.moved(-back, 0)))
            after = Line((_MIDDLE.moved(on, 0), Point(SAMPLE - 2, _MIDDLE.y)))
            yield words, (before, *sign, after)
    if _has_groups(diagram):
        corner = Point(SAMPLE - 12, _MIDDLE.y)
        line = Line((Point(0, corner.y), corner.moved(-7, 0)))
        frame = Box(Rectangle(corner.x, 3, 12, ROW - 6), Ink.FRAME, Ink.FAINT, 3)
        yield "parenthesis", (line, parenthesis(corner, -1, 0), frame)
    if any(isinstance(each, Loop) for each in elements):
        circle = Ellipse(Rectangle(_MIDDLE.x - 8, _MIDDLE.y - 8, 16, 16), Ink.PAPER, Ink.LINE)
        yield "repetition", (circle, *centred(["μ"], _MIDDLE, size=11))
    handlers = [each for each in elements if isinstance(each, Handler)]
    if any(each.guard is None for each in handlers):
        yield "exception", tuple(warning_sign(_MIDDLE, exclaims=True))
    if any(each.guard is not None for each in handlers):
        yield "interrupt", tuple(warning_sign(_MIDDLE, exclaims=False))


def _has_groups(diagram: CompositionDiagram) -> bool:
    """Whether a line ends at a frame, because an operand of a relation has parts itself."""
    return any(
        not isinstance(part, Activity | Guard | Case | Handler)
        and not (isinstance(element, Chain) and isinstance(part, Guarded))
        for element in diagram.elements()
        if not isinstance(element, NamedGroup | Inside | Replication)
        for part in parts(element)
    )
