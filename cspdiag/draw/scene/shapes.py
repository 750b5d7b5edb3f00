"""A drawing as positioned shapes and texts, from which SVG, PNG and PDF are made. A scene says what things are
(``Ink``), never which colour they have: colours belong to the scheme, light or dark. Later items are drawn over earlier
ones. Items are given in absolute places.
"""

from __future__ import annotations

from enum import Enum

from cspdiag.base.record import record
from cspdiag.draw.scene.geometry import Point, Rectangle


class Ink(Enum):
    """The role in which something is drawn; the value is its name in CSS."""

    PAPER = "paper"
    """The background."""
    LINE = "line"
    """Channels and relations."""
    TEXT = "text"
    FAINT = "faint"
    """Explanations: types, legends, local names, grids."""
    BORDER = "border"
    """The outline of a process."""
    PROCESS = "process"
    """The inside of a process."""
    SUBMODEL = "submodel"
    """The inside of a submodel, which computes."""
    VARIABLE = "variable"
    """The inside of a variable."""
    FRAME = "frame"
    """The inside of a process that shows its own parts."""
    ACCENT = "accent"
    """Emphasis: a highlighted cycle, a link."""
    ERROR = "error"
    WARNING = "warning"
    ADDED = "added"
    REMOVED = "removed"
    CHANGED = "changed"
    ERROR_FILL = "error-fill"
    WARNING_FILL = "warning-fill"
    ADDED_FILL = "added-fill"
    REMOVED_FILL = "removed-fill"
    CHANGED_FILL = "changed-fill"
    ACCENT_FILL = "accent-fill"


class Face(Enum):
    """A typeface; texts are measured for Arial and Courier New and the fonts made to their measures."""

    SANS = "sans"
    BOLD = "bold"
    ITALIC = "italic"
    MONO = "mono"


class Anchor(Enum):
    """The point of a text that its x refers to."""

    START = "start"
    MIDDLE = "middle"
    END = "end"


class Dash(Enum):
    """The dash pattern of a line; each can be distinguished from the others without colour."""

    SOLID = "solid"
    DASHED = "dashed"
    DOTTED = "dotted"
    DASH_DOTTED = "dash-dotted"


class Head(Enum):
    """The head at the end of a line."""

    NONE = "none"
    ARROW = "arrow"
    """A filled triangle: data go there."""
    OPEN_ARROW = "open-arrow"
    """Two strokes: control goes there."""
    CIRCLE = "circle"
    """A small empty circle: a parenthesis begins."""
    DOT = "dot"
    """A small filled circle: lines are joined."""
    BAR = "bar"
    """A stroke across the line."""


@record
class TextRun:
    """A piece of text of one look."""

    text: str
    face: Face = Face.SANS
    ink: Ink = Ink.TEXT


@record
class Text:
    """Words on one line; ``at`` is on the baseline."""

    at: Point
    runs: tuple[TextRun, ...]
    size: float = 13
    anchor: Anchor = Anchor.START


@record
class Box:
    """A rectangle; ``radius`` rounds its corners."""

    place: Rectangle
    fill: Ink | None = Ink.PROCESS
    stroke: Ink | None = Ink.BORDER
    radius: float = 0
    width: float = 1.2
    dash: Dash = Dash.SOLID


@record
class Ellipse:
    """An ellipse that fills ``place``."""

    place: Rectangle
    fill: Ink | None = Ink.PROCESS
    stroke: Ink | None = Ink.BORDER
    width: float = 1.2
    dash: Dash = Dash.SOLID


@record
class Line:
    """A line through points, or an outline where it is ``closed``; ``corner`` is the radius of its bends.

    The line ends where its head begins to be drawn over it, so that heads point exactly at its last point.
    """

    points: tuple[Point, ...]
    stroke: Ink | None = Ink.LINE
    width: float = 1.2
    dash: Dash = Dash.SOLID
    start: Head = Head.NONE
    end: Head = Head.NONE
    corner: float = 0
    closed: bool = False
    fill: Ink | None = None


@record
class MoveTo:
    """Begins a part of a curve."""

    to: Point


@record
class LineTo:
    """Goes straight."""

    to: Point


@record
class CubicTo:
    """Follows a cubic Bézier curve."""

    first: Point
    second: Point
    to: Point


@record
class Close:
    """Closes the part with a straight line to its beginning."""


Command = MoveTo | LineTo | CubicTo | Close


@record
class Curve:
    """Any outline or line."""

    commands: tuple[Command, ...]
    stroke: Ink | None = Ink.LINE
    fill: Ink | None = None
    width: float = 1.2
    dash: Dash = Dash.SOLID


@record
class Group:
    """Items that belong together, such as a process with its ports.

    ``kind`` is one or more words of CSS (``"process submodel"``); ``id`` any text, made valid and unique when it is
    written; ``title`` the tooltip; ``link`` the address that a click opens.
    """

    kind: str
    items: tuple[Item, ...]
    id: str = ""
    title: str = ""
    link: str = ""


Shape = Box | Ellipse | Line | Curve
Item = Shape | Text | Group


@record
class Scene:
    """A whole drawing; ``title`` and ``description`` are for screen readers."""

    width: float
    height: float
    items: tuple[Item, ...]
    title: str = ""
    description: str = ""
    name: str = ""
    """The prefix of all identifiers, so several drawings can be in one page."""
