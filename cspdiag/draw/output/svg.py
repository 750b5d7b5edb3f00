"""Scenes as SVG: groups with classes and identifiers, tooltips, text as text, colours as CSS custom properties.

The text is the same, to the byte, for the same scene. Every text is given its width, so it fits into its room in any
typeface that the viewer has.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from cspdiag.draw.scene import outline
from cspdiag.draw.scene.palette import DARK, DASHES, LIGHT, SANS, Scheme, colours, family
from cspdiag.draw.scene.scene_geometry import every
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
    Shape,
    Text,
    TextRun,
)
from cspdiag.draw.scene.text_metrics import runs_width
from cspdiag.network.lower.distinct_names import DistinctNames

_UNSEEN = re.compile(
    r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\ufeff\ud800-\udfff\ufffe\uffff]"
)
"""Characters that XML excludes or that are invisible: control characters, unpaired surrogates, marks that change the
direction of writing.
"""


def render_svg(scene: Scene, scheme: Scheme = Scheme.AUTO) -> str:
    """The drawing as a document of its own, ending in a newline."""
    writer = _Writer(scheme, scene.name, f"cspdiag {scheme.value}")
    inks = sorted({ink for item in every(scene.items) for ink in _inks(item)} | {Ink.PAPER}, key=lambda ink: ink.value)
    body = [*writer.opening(scene), _style(inks, scheme), writer.background(scene)]
    for item in scene.items:
        body += writer.item(item, 1)
    return "\n".join([*body, "</svg>", ""])


def plain_svg(scene: Scene, scheme: Scheme) -> str:
    """The drawing for programs that know no CSS: colours as attributes only."""
    writer = _Writer(scheme, scene.name)
    body = [*writer.opening(scene), writer.background(scene)]
    for item in scene.items:
        body += writer.item(item, 1)
    return "\n".join([*body, "</svg>", ""])


def embedded_svg(scene: Scene) -> str:
    """The drawing for a page that defines the custom properties itself, such as by ``custom_properties``.

    Its links are accessible to screen readers and by keyboard.
    """
    writer = _Writer(Scheme.AUTO, scene.name, role="group")
    body = writer.opening(scene)
    for item in scene.items:
        body += writer.item(item, 1)
    return "\n".join([*body, "</svg>", ""])


def identifiers(scene: Scene) -> dict[str, str]:
    """The ``id`` of each group of the scene as ``embedded_svg`` and ``render_svg`` write it, with that of the scene."""
    writer = _Writer(Scheme.AUTO, scene.name)
    if scene.name:
        writer.identifier("")
    groups = (item for item in every(scene.items) if isinstance(item, Group) and item.id)
    return {writer.identifier(group.id): group.id for group in groups}


def custom_properties(scheme: Scheme) -> str:
    """All colours of a scheme, as declarations of CSS."""
    return " ".join(f"--{ink.value}: {colour};" for ink, colour in colours(scheme).items())


def ink_rules() -> str:
    """The CSS rules that colour the shapes of embedded drawings."""
    return "\n".join(_rules(list(Ink)))


def _rules(inks: Iterable[Ink]) -> Iterator[str]:
    for ink in inks:
        yield f".cspdiag .fill-{ink.value} {{ fill: var(--{ink.value}); }}"
        yield f".cspdiag .stroke-{ink.value} {{ stroke: var(--{ink.value}); }}"


def _style(inks: list[Ink], scheme: Scheme) -> str:
    def definitions(table: dict[Ink, str]) -> str:
        return " ".join(f"--{ink.value}: {table[ink]};" for ink in inks)

    # One page may contain drawings of several schemes, and the rules of each apply to all.
    drawing = f".cspdiag.{scheme.value}"
    lines = [f"{drawing} {{ {definitions(colours(scheme))} }}"]
    if scheme is Scheme.AUTO:
        lines.append(f"@media (prefers-color-scheme: dark) {{ {drawing} {{ {definitions(DARK)} }} }}")
        lines.append(f"@media print {{ {drawing} {{ {definitions(LIGHT)} }} }}")
    inside = "\n".join(f"    {line}" for line in (*lines, *_rules(inks)))
    return f"  <style>\n{inside}\n  </style>"


def _inks(item: Item) -> list[Ink]:
    match item:
        case Box() | Ellipse():
            used = [item.fill, item.stroke]
        case Line() | Curve():
            # The circle at the end of a line is filled with the colour of the paper.
            used = [item.fill, item.stroke, Ink.PAPER]
        case Text():
            used = [run.ink for run in item.runs]
        case Group():
            used = []
    return [ink for ink in used if ink is not None]


def visible(text: str) -> str:
    """A text for pages and pictures, where each character that cannot be shown is marked as such."""
    return _UNSEEN.sub("\N{REPLACEMENT CHARACTER}", text)


def _escaped(text: str) -> str:
    return visible(text).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")


def _number(value: float) -> str:
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


class _Writer:
    """Writes items line by line; keeps identifiers valid and different."""

    def __init__(self, scheme: Scheme, name: str, look: str = "cspdiag", role: str = "img") -> None:
        self._classes = look
        self._role = role
        self._colours = colours(scheme)
        self._name = name
        self._given = DistinctNames()

    def opening(self, scene: Scene) -> list[str]:
        size = f'width="{_number(scene.width)}" height="{_number(scene.height)}"'
        view = f'viewBox="0 0 {_number(scene.width)} {_number(scene.height)}"'
        identity = f' id="{self.identifier("")}"' if self._name else ""
        lines = [
            f'<svg xmlns="http://www.w3.org/2000/svg" class="{self._classes}"{identity} {size} {view} '
            f'role="{self._role}" '
            f'font-family="{SANS}" stroke-linejoin="round">'
        ]
        if scene.title:
            lines.append(f"  <title>{_escaped(scene.title)}</title>")
        if scene.description:
            lines.append(f"  <desc>{_escaped(scene.description)}</desc>")
        return lines

    def background(self, scene: Scene) -> str:
        paint = self._paint(Ink.PAPER, None)
        return f'  <rect {paint} width="{_number(scene.width)}" height="{_number(scene.height)}"/>'

    def item(self, item: Item, depth: int) -> Iterator[str]:
        match item:
            case Group():
                yield from self._group(item, depth)
            case Text():
                yield "  " * depth + self._text(item)
            case Line():
                for shape in outline.shapes(item):
                    yield "  " * depth + self._shape(shape)
            case Box() | Ellipse() | Curve():
                yield "  " * depth + self._shape(item)

    def _group(self, group: Group, depth: int) -> Iterator[str]:
        indent = "  " * depth
        identity = f' id="{self.identifier(group.id)}"' if group.id else ""
        yield f'{indent}<g class="{_escaped(group.kind)}"{identity}>'
        if group.title:
            yield f"{indent}  <title>{_escaped(group.title)}</title>"
        inner = depth + 1
        if group.link:
            yield f'{indent}  <a href="{_escaped(group.link)}">'
            inner += 1
        for item in group.items:
            yield from self.item(item, inner)
        if group.link:
            yield f"{indent}  </a>"
        yield f"{indent}</g>"

    def identifier(self, text: str) -> str:
        """A valid identifier that was not given before."""
        words = [re.sub(r"[^A-Za-z0-9_]+", "-", part).strip("-") for part in (self._name, text)]
        wanted = "-".join(word for word in words if word) or "part"
        if not wanted[0].isalpha():
            wanted = f"part-{wanted}"
        return self._given.fresh(wanted, lambda count: f"{wanted}-{count}")

    def _paint(self, fill: Ink | None, stroke: Ink | None) -> str:
        """Classes, and attributes for viewers that know no custom properties."""
        classes = [f"fill-{fill.value}"] if fill else []
        classes += [f"stroke-{stroke.value}"] if stroke else []
        attributes = [f'class="{" ".join(classes)}"'] if classes else []
        attributes.append(f'fill="{self._colours[fill] if fill else "none"}"')
        if stroke:
            attributes.append(f'stroke="{self._colours[stroke]}"')
        return " ".join(attributes)

    def _shape(self, shape: Shape) -> str:
        stroke = ""
        if shape.stroke is not None:
            stroke = f' stroke-width="{_number(shape.width)}"'
            if DASHES[shape.dash]:
                stroke += f' stroke-dasharray="{" ".join(map(_number, DASHES[shape.dash]))}"'
        paint = self._paint(shape.fill, shape.stroke) + stroke
        match shape:
            case Box():
                place = shape.place
                radius = f' rx="{_number(shape.radius)}"' if shape.radius else ""
                return (
                    f'<rect {paint} x="{_number(place.x)}" y="{_number(place.y)}" '
                    f'width="{_number(place.width)}" height="{_number(place.height)}"{radius}/>'
                )
            case Ellipse():
                centre, place = shape.place.centre, shape.place
                return (
                    f'<ellipse {paint} cx="{_number(centre.x)}" cy="{_number(centre.y)}" '
                    f'rx="{_number(place.width / 2)}" ry="{_number(place.height / 2)}"/>'
                )
            case Curve():
                return f'<path {paint} d="{path_data(shape.commands)}"/>'
            case Line():
                raise AssertionError("lines are drawn by their outline")

    def _text(self, text: Text) -> str:
        runs = [run for run in text.runs if run.text]
        width = runs_width(runs, text.size)
        anchor = "" if text.anchor is Anchor.START else f' text-anchor="{text.anchor.value}"'
        length = f' textLength="{_number(width)}" lengthAdjust="spacingAndGlyphs"' if width > text.size else ""
        start = (
            f'<text x="{_number(text.at.x)}" y="{_number(text.at.y)}" font-size="{_number(text.size)}"{anchor}{length}'
        )
        if len(runs) == 1:
            return f"{start} {self._look(runs[0])}>{_escaped(runs[0].text)}</text>"
        pieces = "".join(f"<tspan {self._look(run)}>{_escaped(run.text)}</tspan>" for run in runs)
        return f'{start} xml:space="preserve">{pieces}</text>'

    def _look(self, run: TextRun) -> str:
        look = self._paint(run.ink, None)
        match run.face:
            case Face.SANS:
                return look
            case Face.BOLD:
                return f'{look} font-weight="700"'
            case Face.ITALIC:
                return f'{look} font-style="italic"'
            case Face.MONO:
                return f'{look} font-family="{family(run.face)}"'


def path_data(commands: Iterable[Command]) -> str:
    """A curve as the ``d`` of a path."""
    words: list[str] = []
    for command in commands:
        match command:
            case MoveTo():
                words.append(f"M{_number(command.to.x)} {_number(command.to.y)}")
            case LineTo():
                words.append(f"L{_number(command.to.x)} {_number(command.to.y)}")
            case CubicTo():
                points = (command.first, command.second, command.to)
                words.append("C" + " ".join(f"{_number(point.x)} {_number(point.y)}" for point in points))
            case Close():
                words.append("Z")
    return "".join(words)
