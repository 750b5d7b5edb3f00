"""Scenes as PDF, one per page, each page exactly as large as its drawing. Text stays text."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from typing import Any

from cspdiag.draw.missing import missing
from cspdiag.draw.scene import outline
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.palette import DASHES, Scheme, colours
from cspdiag.draw.scene.scene_geometry import bounds
from cspdiag.draw.scene.shapes import (
    Anchor,
    Box,
    Close,
    Command,
    CubicTo,
    Curve,
    Ellipse,
    Face,
    Group,
    Ink,
    Item,
    Line,
    LineTo,
    MoveTo,
    Scene,
    Text,
    TextRun,
)
from cspdiag.draw.scene.text_metrics import runs_width, text_width
from cspdiag.draw.scene.typefaces import typeface

POINTS = 72 / 96
"""Points per pixel."""

_EPOCH = datetime(2000, 1, 1, tzinfo=UTC)
"""A fixed creation time, so the same drawing gives the same file."""

_ROUND = 0.5523
_STYLES = {Face.SANS: "", Face.BOLD: "B", Face.ITALIC: "I", Face.MONO: ""}


def render_pdf(scenes: Sequence[Scene], scheme: Scheme = Scheme.LIGHT) -> bytes:
    """The drawings on pages of their sizes; ``Scheme.AUTO`` is light. Raises MissingToolError without
    ``cspdiag[draw]``.
    """
    try:
        from fpdf import FPDF
    except ModuleNotFoundError:
        raise missing("fpdf2") from None
    pdf = FPDF(unit="pt")
    pdf.set_creation_date(_EPOCH)
    pdf.set_creator("cspdiag")
    pdf.set_auto_page_break(False)
    pdf.set_margin(0)
    if scenes and scenes[0].title:
        pdf.set_title(scenes[0].title)
    families = _add_typefaces(pdf)
    for scene in scenes:
        pdf.add_page(format=(scene.width * POINTS, scene.height * POINTS))
        _Page(pdf, colours(scheme), families).draw(scene)
    return bytes(pdf.output())


def _add_typefaces(pdf: Any) -> dict[Face, str]:
    families: dict[Face, str] = {}
    for face in Face:
        path = typeface(face)
        families[face] = {True: "Cousine", False: "Arimo"}[face is Face.MONO] if path else "Helvetica"
        if path:
            pdf.add_font(families[face], _STYLES[face], path)
    if families[Face.MONO] == "Helvetica":
        families[Face.MONO] = "Courier"
    return families


class _Page:
    """Draws the items of a scene on the current page."""

    def __init__(self, pdf: Any, table: dict[Ink, str], families: dict[Face, str]) -> None:
        self._pdf = pdf
        self._colours = table
        self._families = families

    def draw(self, scene: Scene) -> None:
        self._curve(_rectangle(Rectangle(0, 0, scene.width, scene.height), 0), Ink.PAPER, None, 0, ())
        for item in scene.items:
            self._item(item)

    def _item(self, item: Item) -> None:
        match item:
            case Group():
                for each in item.items:
                    self._item(each)
                if item.link.startswith(("http://", "https://")):
                    place = bounds(item)
                    corner = (place.x * POINTS, place.y * POINTS, place.width * POINTS, place.height * POINTS)
                    self._pdf.link(*corner, link=item.link)
            case Text():
                self._text(item)
            case Line():
                for shape in outline.shapes(item):
                    self._item(shape)
            case Box():
                self._shape(item, _rectangle(item.place, item.radius))
            case Ellipse():
                self._shape(item, _ellipse(item.place))
            case Curve():
                self._shape(item, item.commands)

    def _shape(self, shape: Box | Ellipse | Curve, commands: tuple[Command, ...]) -> None:
        self._curve(commands, shape.fill, shape.stroke, shape.width, DASHES[shape.dash])

    def _curve(
        self,
        commands: tuple[Command, ...],
        fill: Ink | None,
        stroke: Ink | None,
        width: float,
        dashes: tuple[float, ...],
    ) -> None:
        with self._pdf.new_path() as path:
            path.style.fill_color = self._colours[fill] if fill else None
            path.style.stroke_color = self._colours[stroke] if stroke else None
            path.style.stroke_width = width * POINTS
            path.style.stroke_join_style = "round"
            path.style.stroke_dash_pattern = [length * POINTS for length in dashes] or None
            path.style.auto_close = False
            for command in commands:
                _follow(path, command)

    def _text(self, text: Text) -> None:
        width = runs_width(text.runs, text.size)
        shift = {Anchor.START: 0.0, Anchor.MIDDLE: width / 2, Anchor.END: width}[text.anchor]
        left = text.at.x - shift
        for run in text.runs:
            self._run(run, Point(left, text.at.y), text.size)
            left += text_width(run.text, text.size, run.face)

    def _run(self, run: TextRun, at: Point, size: float) -> None:
        if not run.text.strip():
            return
        family = self._families[run.face]
        self._pdf.set_font(family, _STYLES[run.face], size * POINTS)
        self._pdf.set_text_color(self._colours[run.ink])
        shown = run.text if family in {"Arimo", "Cousine"} else run.text.encode("latin-1", "replace").decode("latin-1")
        self._pdf.text(at.x * POINTS, at.y * POINTS, shown)


def _follow(path: Any, command: Command) -> None:
    def given(*points: Point) -> list[float]:
        return [length * POINTS for point in points for length in (point.x, point.y)]

    match command:
        case MoveTo():
            path.move_to(*given(command.to))
        case LineTo():
            path.line_to(*given(command.to))
        case CubicTo():
            path.curve_to(*given(command.first, command.second, command.to))
        case Close():
            path.close()


def _rectangle(place: Rectangle, radius: float) -> tuple[Command, ...]:
    radius = min(radius, place.width / 2, place.height / 2)
    if radius <= 0:
        corners = (Point(place.right, place.y), Point(place.right, place.bottom), Point(place.x, place.bottom))
        return (MoveTo(Point(place.x, place.y)), *map(LineTo, corners), Close())
    return _rounded(place, radius, radius)


def _ellipse(place: Rectangle) -> tuple[Command, ...]:
    return _rounded(place, place.width / 2, place.height / 2)


def _rounded(place: Rectangle, rx: float, ry: float) -> tuple[Command, ...]:
    """A rectangle whose corners are quarters of ellipses, from its upper left one clockwise."""
    commands: list[Command] = [MoveTo(Point(place.x + rx, place.y))]
    corners: list[tuple[Callable[[float, float], Point], float, float]] = [
        (lambda along, across: Point(place.right - along, place.y + across), rx, ry),
        (lambda along, across: Point(place.right - across, place.bottom - along), ry, rx),
        (lambda along, across: Point(place.x + along, place.bottom - across), rx, ry),
        (lambda along, across: Point(place.x + across, place.y + along), ry, rx),
    ]
    for at, along, across in corners:
        commands.append(LineTo(at(along, 0)))
        commands.append(CubicTo(at(along * (1 - _ROUND), 0), at(0, across * (1 - _ROUND)), at(0, across)))
    return (*commands, Close())
