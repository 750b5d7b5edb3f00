"""Draws what changed: both versions of a diagram in one, added elements green with a plus, removed ones red and dashed,
changed ones amber.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeVar

from cspdiag.base.record import replaced
from cspdiag.draw.annotations import Note, heading, notes
from cspdiag.draw.communication.diagram import draw_communication
from cspdiag.draw.composition.diagram import draw_composition
from cspdiag.draw.differences.change import Action, Change
from cspdiag.draw.differences.programs import Difference, Pair
from cspdiag.draw.differences.render_text import reported, sentence
from cspdiag.draw.elements.diagram import Arrow, Box, CommunicationDiagram, Element
from cspdiag.draw.elements.marks import WHOLE, Mark, MarkKind
from cspdiag.draw.scene.scene_geometry import bounds, fitted, moved, stacked
from cspdiag.draw.scene.shapes import Face, Group, Item, Scene, TextRun

_MARKS: dict[Action, MarkKind] = {"added": "added", "removed": "removed", "changed": "changed", "renamed": "changed"}
_GAP = 14.0
LOST = " (before)"
GAINED = " (after)"
"""Suffixes of the keys of arrows that represent ends which a relationship has lost or gained."""


def pictures_of(difference: Difference) -> list[Scene]:
    """A picture for each definition whose diagrams changed, and one that lists the changes of all others.

    Raises the same exceptions as ``lay_out``.
    """
    pairs = [
        pair
        for pair in difference.diagrams
        if any(change.action != "renamed" or change.subject for change in pair.changes)
    ]
    scenes = [_picture(pair) for pair in pairs]
    drawn = {(change.kind, change.definition) for pair in pairs for change in pair.changes}
    others = [change for change in difference.changes if (change.kind, change.definition) not in drawn]
    if others or not scenes:
        title = TextRun("Other definitions" if scenes else "Changes" if others else "No changes", Face.BOLD)
        listed = _listed(others, name_definitions=True)
        parts: list[Item] = [heading((title,), None)]
        if listed is not None:
            parts.append(moved(listed, 0, bounds(parts[0]).height + _GAP))
        scenes.append(fitted(parts, title="changes", name="changes"))
    return scenes


def union(before: CommunicationDiagram | None, after: CommunicationDiagram | None) -> CommunicationDiagram:
    """A diagram with the elements of both versions; common elements are as in the later version."""
    if before is None or after is None:
        whole = after or before
        assert whole is not None
        return whole
    earlier = {vertex.key: vertex for vertex in before.vertices}
    vertices = []
    for vertex in after.vertices:
        old = earlier.get(vertex.key)
        if isinstance(vertex, Box) and isinstance(old, Box):
            vertex = replaced(vertex, ports=(*vertex.ports, *_missing(old.ports, vertex.ports)))
        vertices.append(vertex)
    arrows = [part for arrow in after.arrows for part in _split(before, arrow)]
    return replaced(
        after,
        vertices=(*vertices, *_missing(before.vertices, after.vertices)),
        arrows=(*arrows, *_missing(before.arrows, after.arrows)),
    )


def _split(before: CommunicationDiagram, arrow: Arrow) -> list[Arrow]:
    """A relationship whose ends have changed: one arrow each for the ends that it has kept, gained and lost."""
    old = next((each for each in before.arrows if each.key == arrow.key), arrow)
    sources = tuple(end for end in arrow.sources if end in old.sources)
    sinks = tuple(end for end in arrow.sinks if end in old.sinks)
    parts = [replaced(arrow, sources=sources, sinks=sinks)] if sources and sinks else []
    for whole, suffix in ((arrow, GAINED), (old, LOST)):
        own_sources = tuple(end for end in whole.sources if end not in sources)
        own_sinks = tuple(end for end in whole.sinks if end not in sinks)
        if own_sources or own_sinks:
            ends = {"sources": own_sources or whole.sources, "sinks": own_sinks or whole.sinks}
            named = {} if not parts and suffix == GAINED else {"label": None, "type": None}
            parts.append(replaced(whole, key=f"{arrow.key}{suffix}", **named, **ends))
    return parts


E = TypeVar("E", bound=Element)


def _missing(old: Sequence[E], new: Sequence[E]) -> list[E]:
    kept = {element.key for element in new}
    return [element for element in old if element.key not in kept]


def marks(pair: Pair) -> dict[str, Mark]:
    """The marks of the elements of the united diagram, each with its message."""
    changes_by_key: dict[str, list[Change]] = {}
    for change in pair.changes:
        changes_by_key.setdefault(change.key, []).append(change)
    before, after, shown = _keys(pair.before), _keys(pair.after), _keys(union(pair.before, pair.after))
    found: dict[str, Mark] = {}
    for key in shown:
        whole = key.removesuffix(LOST).removesuffix(GAINED)
        changes = changes_by_key.get(whole, [])
        note = "\n".join(sentence(change) for change in changes)
        if key not in before and key not in after:
            found[key] = Mark("removed" if key.endswith(LOST) else "added", note=note)
        elif key not in before or key not in after:
            found[key] = Mark("added" if key in after else "removed", note=note)
        elif any(change.aspect not in ("from", "to") for change in changes):
            found[key] = Mark("changed", note=note)
    if pair.before is None or pair.after is None:
        found[WHOLE] = Mark("added" if pair.before is None else "removed")
    elif any(change.subject in ("", "parameter") for change in pair.changes):
        found[WHOLE] = Mark("changed")
    return found


def _keys(diagram: CommunicationDiagram | None) -> list[str]:
    if diagram is None:
        return []
    ports = [f"{box.key}.{port.key}" for box in diagram.boxes for port in box.ports]
    return [*(element.key for element in diagram.elements()), *ports]


def _picture(pair: Pair) -> Scene:
    scenes = [draw_communication(union(pair.before, pair.after), marks=marks(pair))]
    if pair.composition is not None and pair.composition.marks:
        scenes.append(draw_composition(pair.composition.diagram, marks=pair.composition.marks))
    listed = _listed(pair.changes)
    if listed is not None:
        scenes.append(fitted([listed]))
    return stacked(scenes)


def _listed(changes: Iterable[Change], *, name_definitions: bool = False) -> Group | None:
    """The list of changes, one below the other; None without changes."""
    rows = []
    for change in reported(changes):
        of = f"{change.kind} {change.definition}: " if name_definitions and (change.subject or change.aspect) else ""
        rows.append(Note(Mark(_MARKS[change.action]), "", f"{of}{sentence(change)}", ""))
    return notes(rows, 0) if rows else None
