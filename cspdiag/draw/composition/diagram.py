"""Draws composition diagrams: processes joined by lines that carry their operators, after Hilderink's CSP diagrams.

The notation is explained in docs/notation.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import assert_never

from cspdiag.base import Diagnostic
from cspdiag.draw.annotations import SMALLEST_ROW, heading, messages
from cspdiag.draw.communication.legend import in_rows
from cspdiag.draw.composition import relations as relations
from cspdiag.draw.composition.blocks import PADDING, SIZE, Block, FrameStyle, framed, look, width_of
from cspdiag.draw.composition.legend import explanations
from cspdiag.draw.composition.shapes import (
    HEAD,
    activity_block,
    condition_block,
    exception_block,
    guard_block,
    operator_sign,
)
from cspdiag.draw.composition.tooltips import step_tooltip
from cspdiag.draw.elements.composition import (
    Activity,
    Chain,
    Choice,
    Composition,
    CompositionDiagram,
    Guarded,
    Handler,
    Inside,
    Loop,
    NamedGroup,
    Replication,
    Watched,
)
from cspdiag.draw.elements.marks import Marks
from cspdiag.draw.hiding import NOTHING_HIDDEN, Hidden
from cspdiag.draw.scene.geometry import Point
from cspdiag.draw.scene.scene_geometry import below_each_other, bounds, fitted
from cspdiag.draw.scene.shapes import Face, Group, Head, Ink, Item, Line, Scene, Text, TextRun
from cspdiag.draw.scene.text_metrics import runs_width
from cspdiag.syntax.parse.nesting import raised_recursion_limit

WIDEST = 1000.0
"""A sequence continues in a new row beyond this, in pixels."""
_NARROWEST = 360.0
GAP = 26.0
"""Between heading, drawing and messages."""


@raised_recursion_limit()
def draw_composition(
    diagram: CompositionDiagram,
    *,
    marks: Marks | None = None,
    diagnostics: Mapping[int, Diagnostic] | None = None,
    links: Mapping[str, str] | None = None,
    hidden: Hidden = NOTHING_HIDDEN,
    is_headed: bool = True,
) -> Scene:
    """A composition diagram with its heading, a legend of the signs that occur, and the messages to which the marks
    refer.

    ``marks`` are by the key of the element (``1.2``); ``links`` lead from the definition of an instance to an address.
    A process without a composition has an empty diagram.
    """
    parts: list[Item] = []
    if is_headed:
        parts.append(heading((TextRun("composition of ", ink=Ink.FAINT), TextRun(diagram.key, Face.BOLD)), None))
    if diagram.root is not None:
        drawer = _Drawer(marks or {}, links or {})
        parts.append(Group("diagram", drawer.whole(diagram.root).items))
    width = max(SMALLEST_ROW, bounds(parts[-1]).width if parts else 0)
    explained = None if hidden.hides("legend") else in_rows(list(explanations(diagram)), width)
    if explained is not None:
        parts.append(explained)
    if diagnostics:
        parts.append(messages(diagnostics.items(), width))
    return fitted(
        below_each_other(parts, GAP),
        title=f"composition of {diagram.key}",
        description=diagram.doc or "",
        name=f"{diagram.key}-composition",
    )


class _Drawer:
    def __init__(self, marks: Marks, links: Mapping[str, str]) -> None:
        self._marks = marks
        self._links = links

    def whole(self, root: Composition) -> Block:
        """The whole diagram; it has a frame only if the frame carries a mark."""
        return self.operand(root, WIDEST) if root.key in self._marks else self.bare(root, WIDEST)

    def operand(self, element: Composition, limit: float) -> Block:
        """An operand of a relation: one shape, or a group."""
        if isinstance(element, Activity | NamedGroup | Replication | Inside):
            return self.bare(element, limit)
        style = FrameStyle(
            f"group {type(element).__name__.lower()}",
            element.key,
            title=step_tooltip(element),
            mark=self._marks.get(element.key),
        )
        return framed(self.bare(element, limit - 2 * PADDING), style)

    def bare(self, element: Composition, limit: float) -> Block:
        """An element without a frame of its own."""
        limit = max(limit, _NARROWEST)
        match element:
            case Activity():
                return activity_block(
                    element, self._marks.get(element.key), self._links.get(element.definition or "", "")
                )
            case Chain():
                return self._chain(element, limit)
            case Guarded():
                return self._guarded(element, limit)
            case Loop():
                body = self.operand(element.process, limit - 90)
                mark = None if element.condition is None else self._marks.get(element.condition.key)
                return relations.loop(body, element, mark, step_tooltip(element))
            case Choice():
                return self._choice(element, limit)
            case Watched():
                return self._watched(element, limit)
            case Replication():
                return self._replication(element, limit)
            case NamedGroup():
                return self._named("group named", element, (TextRun(element.label, Face.BOLD),), limit)
            case Inside():
                name = (TextRun(element.text, Face.BOLD), TextRun(f": {element.definition}"))
                return self._named("group inside", element, name, limit)
            case _:
                assert_never(element)

    def _chain(self, chain: Chain, limit: float) -> Block:
        if chain.operator == "sequence":
            return relations.sequence([self.operand(part, limit) for part in chain.parts], limit)
        branches = [part for part in chain.parts if isinstance(part, Guarded)]
        guards = [guard_block(branch.guard, self._marks.get(branch.guard.key)) for branch in branches]
        widest = max((guard.width for guard in guards), default=0)
        by_key = {branch.key: guard.at_least(widest) for branch, guard in zip(branches, guards, strict=True)}
        blocks = [
            self._guarded(part, limit, by_key[part.key])
            if isinstance(part, Guarded) and part.key not in self._marks
            else self.operand(part, limit)
            for part in chain.parts
        ]
        if chain.operator == "parallel":
            blocks = list(relations.equally_wide(blocks))
        return relations.vertical(blocks, chain.operator, chain.prioritized)

    def _guarded(self, element: Guarded, limit: float, guard: Block | None = None) -> Block:
        guard = guard or guard_block(element.guard, self._marks.get(element.guard.key))
        return relations.guarded(guard, self.operand(element.process, limit - guard.width - 40))

    def _choice(self, element: Choice, limit: float) -> Block:
        conditions = [
            condition_block(case, self._marks.get(case.key), is_first=number == 0)
            for number, case in enumerate(element.cases)
        ]
        rest = limit - max(condition.width for condition in conditions) - 40
        processes = [self.operand(case.process, rest) for case in element.cases]
        otherwise = None if element.otherwise is None else self.operand(element.otherwise, rest)
        return relations.choice(conditions, processes, otherwise)

    def _watched(self, element: Watched, limit: float) -> Block:
        process = self.operand(element.process, limit)
        return relations.watched(process, [self._watch(handler, limit) for handler in element.handlers])

    def _watch(self, handler: Handler, limit: float) -> relations.Watch:
        mark = self._marks.get(handler.key)
        if handler.guard is None:
            guard = exception_block(handler, mark)
        else:
            guard = guard_block(handler.guard, self._marks.get(handler.guard.key, mark))
        process = self.operand(handler.process, limit - guard.width - 100)
        return relations.Watch(guard, process, handler.guard is None, look(mark, Ink.LINE, Ink.PAPER).stroke)

    def _named(self, kind: str, element: NamedGroup | Inside, name: tuple[TextRun, ...], limit: float) -> Block:
        text = Text(Point(0, 0), name, SIZE)
        mark = self._marks.get(element.key)
        style = FrameStyle(kind, element.key, step_tooltip(element), mark, (text,), runs_width(name, SIZE))
        return framed(self.bare(element.process, limit - 2 * PADDING), style)

    def _replication(self, element: Replication, limit: float) -> Block:
        name: list[Item] = []
        if element.operator == "sequence":
            name.append(Line((Point(0, -5), Point(16, -5)), end=Head.OPEN_ARROW))
        else:
            name += operator_sign(element.operator, element.prioritized, Point(8, -5))[0]
        name.append(Text(Point(24, 0), (TextRun(element.replicator),), SIZE))
        style = FrameStyle(
            "group replicated",
            element.key,
            step_tooltip(element),
            self._marks.get(element.key),
            tuple(name),
            24 + width_of([element.replicator]),
            name_height=22 + HEAD * element.prioritized,
            copies=3,
        )
        return framed(self.bare(element.process, limit - 2 * PADDING), style)
