"""The pictures of a program: which definitions have one, and both diagrams of a definition on one sheet."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Literal, TypeAlias

from cspdiag.base import Diagnostic, Span
from cspdiag.base.record import record
from cspdiag.draw.communication.diagram import draw_communication
from cspdiag.draw.composition.diagram import draw_composition
from cspdiag.draw.elements.communication import Drawn, communication_diagram
from cspdiag.draw.elements.composition import CompositionDiagram
from cspdiag.draw.elements.diagram import CommunicationDiagram
from cspdiag.draw.elements.facts import Facts
from cspdiag.draw.elements.marks import mark_of_rest, marks_of, numbered
from cspdiag.draw.elements.read_composition import composition_diagram
from cspdiag.draw.hiding import KINDS_OF_LABELS, NOTHING_HIDDEN, Hidden
from cspdiag.draw.scene.scene_geometry import stacked
from cspdiag.draw.scene.shapes import Scene
from cspdiag.model.program import Program
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.network.analyse import Analysis

Which: TypeAlias = Literal["communication", "composition", "both"]


@record
class PictureOptions:
    """How something is to be drawn; ``depth`` 2 shows the inside of the instances."""

    which: Which = "both"
    hidden: Hidden = NOTHING_HIDDEN
    depth: int = 1


DEFAULT = PictureOptions()


class Pictures:
    """Draws the processes and environments of a program, which may have errors.

    With ``diagnostics`` each picture marks the elements that they concern and lists them.
    """

    def __init__(
        self, program: Program, diagnostics: Iterable[Diagnostic] = (), analysis: Analysis | None = None
    ) -> None:
        self.program = program
        self.analysis = analysis
        self.diagnostics = tuple(diagnostics)

    @cached_property
    def facts(self) -> Facts:
        """The compiler's results about the program."""
        return Facts(self.program, self.analysis)

    def drawn(self, *, imported: bool = False) -> list[Drawn]:
        """The processes and environments of the main file in text order; also those of imported files if requested."""
        own = set(self.program.main.items)
        return [
            definition
            for definition in self.program.definitions.values()
            if isinstance(definition, ast.ProcessDefinition | ast.EnvironmentDefinition)
            and (imported or definition in own)
        ]

    def named(self, name: str) -> Drawn | None:
        """The process or environment of that name."""
        found = self.program.definitions.get(name)
        return found if isinstance(found, Drawn) else None

    def outermost(self) -> Drawn | None:
        """What is drawn when nothing is named: the process of the first environment, or else the outermost process of
        the other commands.
        """
        drawn = self.drawn()
        for definition in drawn:
            if isinstance(definition, ast.EnvironmentDefinition):
                process = self.named(definition.process.text)
                if process is not None:
                    return process
        from cspdiag.network.elaborate.definitions import Definitions

        found = Definitions(self.program).outermost()
        return found if found in drawn else drawn[-1] if drawn else None

    def concerned(self, definition: Drawn) -> dict[int, Diagnostic]:
        """The diagnostics that lie in a definition, numbered from 1."""
        span = definition.span
        return numbered(
            found
            for found in self.diagnostics
            if found.span.source is span.source and span.start <= found.span.start and found.span.end <= span.end
        )

    def communication(self, definition: Drawn, depth: int = 1) -> CommunicationDiagram:
        """The elements of the communication diagram."""
        return communication_diagram(self.program, self.facts, definition, depth)

    def labels(self, definitions: Iterable[Drawn], depth: int = 1) -> frozenset[str]:
        """The names of labels that can be hidden in some pictures, and the words for sorts of labels."""
        found = {*KINDS_OF_LABELS}
        for definition in definitions:
            pending = [self.communication(definition, depth)]
            while pending:
                diagram = pending.pop()
                found.update(element.key for element in diagram.elements())
                found.update(port.key for box in diagram.boxes for port in box.ports)
                pending += [box.inside for box in diagram.boxes if box.inside is not None]
        return frozenset(found)

    def composition(self, definition: Drawn, depth: int = 1) -> CompositionDiagram | None:
        """The elements of the composition diagram; None if the process has no composition."""
        if not isinstance(definition, ast.ProcessDefinition) or definition.composition is None:
            return None
        return composition_diagram(self.program.definitions, definition, depth)

    def scene(
        self, definition: Drawn, options: PictureOptions = DEFAULT, links: Mapping[str, str] | None = None
    ) -> Scene:
        """The picture of a process or an environment. Raises the same exceptions as ``lay_out``."""
        found = self.concerned(definition)
        composition = None if options.which == "communication" else self.composition(definition, options.depth)
        steps = {} if composition is None else {element.key: element.spans for element in composition.elements()}
        step_marks = marks_of(steps, found)
        scenes: list[Scene] = []
        if options.which != "composition" or composition is None:
            diagram = self.communication(definition, options.depth)
            marks = marks_of(places_of(diagram), found)
            scenes.append(
                draw_communication(
                    diagram,
                    hidden=options.hidden,
                    marks=marks | mark_of_rest(found, (*marks.values(), *step_marks.values())),
                    diagnostics=found if composition is None else None,
                    links=links,
                )
            )
        if composition is not None:
            scenes.append(
                draw_composition(composition, marks=step_marks, diagnostics=found, links=links, hidden=options.hidden)
            )
        return scenes[0] if len(scenes) == 1 else stacked(scenes)


def places_of(diagram: CommunicationDiagram, prefix: str = "") -> dict[str, tuple[Span, ...]]:
    """The places in the text of all elements of a diagram and of those inside it, by the names that marks use."""
    places: dict[str, tuple[Span, ...]] = {}
    for element in diagram.elements():
        places[f"{prefix}{element.key}"] = element.spans
    for box in diagram.boxes:
        if box.inside is not None:
            places |= places_of(box.inside, f"{prefix}{box.key}/")
    return places
