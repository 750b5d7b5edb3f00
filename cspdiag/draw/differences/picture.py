"""Draws what changed: both versions of a diagram in one, what was added green with a plus, what was removed red and broken, what changed amber."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeVar

from cspdiag.diagnostics.record import replaced
from cspdiag.draw.annotations import Note, heading, notes
from cspdiag.draw.communication import draw_communication
from cspdiag.draw.composition import draw_composition
from cspdiag.draw.differences.change import Action, Change
from cspdiag.draw.differences.programs import Difference, Pair
from cspdiag.draw.differences.render_text import sentence
from cspdiag.draw.elements.composition import CompositionDiagram
from cspdiag.draw.elements.diagram import Arrow, Box, CommunicationDiagram, Element
from cspdiag.draw.elements.marks import Mark, MarkKind
from cspdiag.draw.elements.read_composition import composition_diagram
from cspdiag.draw.scene import Face, Group, Ink, Item, Run, Scene
from cspdiag.draw.scene_geometry import MARGIN, bounds, fitted, moved, stacked
from cspdiag.model.program import Program
from cspdiag.syntax import ast

_MARKS: dict[Action, MarkKind] = {"added": "added", "removed": "removed", "changed": "changed", "renamed": "changed"}
_GAP = 14.0
LOST = " (before)"
"""Ends the key of the arrow that stands for lost ends."""


def pictures_of(difference: Difference, before: Program, after: Program) -> list[Scene]:
    """A picture for each definition whose diagrams changed, and one that lists the changes of all others.

    Raises what ``lay_out`` raises.
    """
    pairs = [
        pair
        for pair in difference.diagrams
        if any(change.action != "renamed" or change.subject for change in pair.changes)
    ]
    scenes = [_picture(pair, before, after) for pair in pairs]
    drawn = {(change.kind, change.definition) for pair in pairs for change in pair.changes}
    others = [change for change in difference.changes if (change.kind, change.definition) not in drawn]
    if others or not scenes:
        title = Run("Other definitions" if scenes else "Changes" if others else "No changes", Face.BOLD)
        listed = _listed(others, name_definitions=True)
        parts: list[Item] = [heading((title,), None)]
        if listed is not None:
            parts.append(moved(listed, 0, bounds(parts[0]).height + _GAP))
        scenes.append(fitted(parts, title="changes", name="changes"))
    return scenes


def union(before: CommunicationDiagram | None, after: CommunicationDiagram | None) -> CommunicationDiagram:
    """A diagram with the elements of both, those of the later version as they are there."""
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
    lost = [arrow for each in after.arrows if (arrow := _lost_ends(before, each)) is not None]
    return replaced(
        after,
        vertices=(*vertices, *_missing(before.vertices, after.vertices)),
        arrows=(*after.arrows, *_missing(before.arrows, after.arrows), *lost),
    )


def _lost_ends(before: CommunicationDiagram, arrow: Arrow) -> Arrow | None:
    """An arrow for the ends that a relationship had before and has no more."""
    old = next((each for each in before.arrows if each.key == arrow.key), None)
    if old is None:
        return None
    sources = tuple(end for end in old.sources if end not in arrow.sources)
    sinks = tuple(end for end in old.sinks if end not in arrow.sinks)
    if not sources and not sinks:
        return None
    return replaced(
        old, key=f"{arrow.key}{LOST}", label=None, type=None, sources=sources or old.sources, sinks=sinks or old.sinks
    )


E = TypeVar("E", bound=Element)


def _missing(old: Sequence[E], new: Sequence[E]) -> list[E]:
    kept = {element.key for element in new}
    return [element for element in old if element.key not in kept]


def marks(pair: Pair) -> dict[str, Mark]:
    """The marks of the elements of the united diagram, each with what is said about it."""
    said: dict[str, list[Change]] = {}
    for change in pair.changes:
        said.setdefault(change.key, []).append(change)
    before = _keys(pair.before)
    after = _keys(pair.after)
    found: dict[str, Mark] = {}
    if pair.before is not None and pair.after is not None:
        lost = [_lost_ends(pair.before, arrow) for arrow in pair.after.arrows]
        found = {arrow.key: Mark("removed") for arrow in lost if arrow is not None}
    for key in [*after, *(key for key in before if key not in after)]:
        note = "\n".join(sentence(change) for change in said.get(key, ()))
        if key not in before or key not in after:
            found[key] = Mark("added" if key in after else "removed", note=note)
        elif key in said:
            found[key] = Mark("changed", note=note)
    return found


def _keys(diagram: CommunicationDiagram | None) -> list[str]:
    if diagram is None:
        return []
    ports = [f"{box.key}.{port.key}" for box in diagram.boxes for port in box.ports]
    return [*(element.key for element in diagram.elements()), *ports]


def _picture(pair: Pair, before: Program, after: Program) -> Scene:
    scenes = [draw_communication(union(pair.before, pair.after), marks=marks(pair))]
    old = _composition(before, pair.definition_before)
    new = _composition(after, pair.definition_after)
    if any(change.subject == "composition" for change in pair.changes):
        scenes += [_version(each, word) for each, word in ((old, "before"), (new, "after")) if each is not None]
    elif old is None or new is None:
        scenes += [_version(each, "") for each in (old, new) if each is not None]
    listed = _listed(pair.changes)
    if listed is not None:
        scenes.append(fitted([listed]))
    return stacked(scenes)


def _composition(program: Program, definition: ast.Definition | None) -> CompositionDiagram | None:
    if not isinstance(definition, ast.ProcessDefinition) or definition.composition is None:
        return None
    return composition_diagram(program.definitions, definition)


def _version(diagram: CompositionDiagram, word: str) -> Scene:
    title = (
        Run("composition of ", ink=Ink.FAINT),
        Run(diagram.key, Face.BOLD),
        Run(f" {word}".rstrip(), ink=Ink.FAINT),
    )
    above = heading(title, None)
    picture = draw_composition(diagram, is_headed=False)
    below = bounds(above).height + _GAP - MARGIN
    return fitted([above, *(moved(item, -MARGIN, below) for item in picture.items)])


def _listed(changes: Iterable[Change], *, name_definitions: bool = False) -> Group | None:
    """The changes below each other; None for none."""
    rows = []
    for change in changes:
        of = f"{change.kind} {change.definition}: " if name_definitions and (change.subject or change.aspect) else ""
        rows.append(Note(Mark(_MARKS[change.action]), "", f"{of}{sentence(change)}", ""))
    return notes(rows, 0) if rows else None
