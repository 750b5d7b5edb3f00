"""What the book of a program says about each of its definitions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.draw.book.highlight import Piece, highlighted
from cspdiag.draw.elements.communication import Drawn
from cspdiag.draw.elements.diagram import FlowKind
from cspdiag.draw.elements.texts import optional, place_in_file, written
from cspdiag.draw.output.svg import embedded_svg
from cspdiag.draw.pictures import PictureOptions, Pictures
from cspdiag.draw.scene.scene_geometry import fitted
from cspdiag.draw.scene.shapes import Group, Scene
from cspdiag.model.program import Program
from cspdiag.syntax import ast
from cspdiag.syntax.walk import instances_in

Described: TypeAlias = ast.ProcessDefinition | ast.EnvironmentDefinition | ast.SubmodelDefinition | ast.DriverDefinition
"""The definitions that have a chapter."""

_SECTIONS = {
    ast.ProcessDefinition: "Processes",
    ast.EnvironmentDefinition: "Environments",
    ast.SubmodelDefinition: "Submodels",
    ast.DriverDefinition: "Drivers",
}

_DECLARATIONS = (
    ast.Constant,
    ast.TypeAliasDefinition,
    ast.EnumDefinition,
    ast.StructDefinition,
    ast.ExceptionDefinition,
    ast.Assertion,
)

_KINDS_IN_WORDS: Mapping[FlowKind, str] = {
    "var": "a variable",
    "sync": "a rendezvous",
    "broadcast": "a broadcast",
    "any": "the first one there",
    "buffer": "a buffer",
    "overwrite": "an overwriting buffer",
    "sampled": "the sample clock",
    "event": "an event of the environment",
    "constant": "a constant",
    "discard": "nobody",
}


@record
class PortRow:
    """A row of the table of ports."""

    name: str
    direction: str
    type: str
    period: str
    meets: str
    doc: str


@record
class ParameterRow:
    """A row of the table of parameters."""

    name: str
    type: str
    default: str
    doc: str


@record
class Figure:
    """A drawing with its caption."""

    kind: str
    svg: str


@record
class Chapter:
    """A definition; ``parts`` and ``used_by`` name other chapters."""

    name: str
    section: str
    doc: str
    place: str
    parameters: tuple[ParameterRow, ...]
    ports: tuple[PortRow, ...]
    parts: tuple[str, ...]
    used_by: tuple[str, ...]
    figures: tuple[Figure, ...]
    lines: tuple[tuple[int, list[Piece]], ...]

    @property
    def anchor(self) -> str:
        """The identifier of the chapter in the page."""
        return anchor(self.name)


def anchor(name: str) -> str:
    """The identifier of the chapter of a definition."""
    return f"of-{name}"


def chapters(pictures: Pictures) -> list[Chapter]:
    """The definitions of the main file and all that they use: processes from the outermost inwards, environments,
    submodels, drivers.

    Raises the same exceptions as ``lay_out``.
    """
    described = _described(pictures)
    links = {name: f"#{anchor(name)}" for name in described}
    users: dict[str, list[str]] = {name: [] for name in described}
    for name, definition in described.items():
        for part in _parts(definition):
            if part in users and name not in users[part]:
                users[part].append(name)
    written_chapters = [_chapter(pictures, described[name], links, tuple(users[name])) for name in described]
    order = list(_SECTIONS.values())
    return sorted(written_chapters, key=lambda chapter: order.index(chapter.section))


def declarations(program: Program, links: Mapping[str, str]) -> list[list[Piece]]:
    """The constants, types, exceptions and assertions of the main file, as highlighted lines."""
    items = [item for item in program.main.items if isinstance(item, _DECLARATIONS)]
    texts = [item.span.source.text[_start_of_doc(item.span) : item.span.end] for item in items]
    return highlighted("\n".join(texts), links) if texts else []


def _described(pictures: Pictures) -> dict[str, Described]:
    definitions = pictures.program.definitions
    own = [item for item in pictures.program.main.items if isinstance(item, tuple(_SECTIONS))]
    first = pictures.outermost()
    pending: list[object] = [*([first] if first else []), *own]
    found: dict[str, Described] = {}
    while pending:
        definition = pending.pop(0)
        if isinstance(definition, Described) and definition.name.text not in found:
            found[definition.name.text] = definition
            pending[:0] = [definitions[name] for name in _parts(definition) if name in definitions]
    return found


def _parts(definition: Described) -> tuple[str, ...]:
    """The names of the definitions of the instances, in text order."""
    names = [instance.definition.text for instance in instances_in(definition)]
    if isinstance(definition, ast.EnvironmentDefinition):
        names.insert(0, definition.process.text)
    return tuple(dict.fromkeys(names))


def _chapter(pictures: Pictures, definition: Described, links: Mapping[str, str], used_by: tuple[str, ...]) -> Chapter:
    return Chapter(
        name=definition.name.text,
        section=_SECTIONS[type(definition)],
        doc=definition.doc or "",
        place=place_in_file(definition.span),
        parameters=_parameters(definition),
        ports=() if isinstance(definition, ast.EnvironmentDefinition) else _ports(pictures, definition),
        parts=tuple(name for name in _parts(definition) if name in links),
        used_by=used_by,
        figures=_figures(pictures, definition, links) if isinstance(definition, Drawn) else (),
        lines=tuple(_lines(definition.span, {name: to for name, to in links.items() if name != definition.name.text})),
    )


def _parameters(definition: Described) -> tuple[ParameterRow, ...]:
    if isinstance(definition, ast.EnvironmentDefinition):
        return ()
    return tuple(
        ParameterRow(item.name.text, written(item.type), optional(item.default) or "", item.doc or "")
        for item in definition.parameters
    )


def _ports(pictures: Pictures, definition: Described) -> tuple[PortRow, ...]:
    assert not isinstance(definition, ast.EnvironmentDefinition)
    rows: list[PortRow] = []
    for ports in definition.ports:
        period = f"@ {written(ports.sampling)}" if ports.sampling else ""
        for port in ports.names:
            kinds = pictures.facts.port(definition, port.name.text).kinds
            rows.append(
                PortRow(
                    written(port),
                    ports.direction,
                    written(ports.type),
                    f"{period} immediate" if ports.immediate else period,
                    ", ".join(_KINDS_IN_WORDS[kind] for kind in kinds),
                    ports.doc or "",
                )
            )
    return tuple(rows)


def _figures(pictures: Pictures, definition: Drawn, links: Mapping[str, str]) -> tuple[Figure, ...]:
    figure_options = [("Communication", PictureOptions(which="communication"))]
    if pictures.composition(definition) is not None:
        figure_options.append(("Composition", PictureOptions(which="composition")))
    figures: list[Figure] = []
    for kind, options in figure_options:
        # The messages concern both figures; the last one shows them.
        left_out = {"heading"} if kind == figure_options[-1][0] else {"heading", "messages"}
        scene = _without(pictures.scene(definition, options, links), left_out, f"{definition.name.text}-{kind}")
        figures.append(Figure(kind, embedded_svg(scene)))
    return tuple(figures)


def _without(scene: Scene, kinds: set[str], name: str) -> Scene:
    """A drawing without the groups of some kinds, and without its heading, which the page has as text."""
    kept = [item for item in scene.items if not (isinstance(item, Group) and item.kind in kinds)]
    return fitted(kept, margin=2, title=scene.title, description=scene.description, name=name)


def _lines(span: Span, links: Mapping[str, str]) -> Iterator[tuple[int, list[Piece]]]:
    start = _start_of_doc(span)
    text = span.source.text[start : span.end]
    return enumerate(highlighted(text, links), span.source.position(start)[0])


def _start_of_doc(span: Span) -> int:
    """Where the doc comment above a definition begins."""
    text = span.source.text
    start = span.start
    while True:
        line = text.rfind("\n", 0, max(start - 1, 0)) + 1
        if start == 0 or text[start - 1] != "\n" or not text[line:start].lstrip().startswith("///"):
            return start
        start = line
