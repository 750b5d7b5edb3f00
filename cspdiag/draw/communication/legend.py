"""Explains the symbols that occur in a diagram, and no others."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeAlias

from cspdiag.draw.communication import symbols
from cspdiag.draw.elements.diagram import Arrow, Box, Sink, Store, Vertex
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.scene_geometry import moved
from cspdiag.draw.scene.shapes import Dash, Group, Head, Ink, Item, Line, Text, TextRun
from cspdiag.draw.scene.text_metrics import ASCENT, line_height, text_width

SIZE = 11.0
SAMPLE = 34.0
"""The width of a sample."""
ROW = 22.0
SPACE = 22.0
"""Between two entries of a row."""

Entry: TypeAlias = "tuple[str, tuple[Item, ...]]"

_KINDS: tuple[tuple[symbols.Symbol, str], ...] = (
    ("sync", "rendezvous"),
    ("var", "variable: the last value written"),
    ("broadcast", "broadcast: each reader gets every value"),
    ("any", "any: the first one there"),
    ("buffer", "buffer"),
    ("overwrite", "overwriting buffer"),
    ("sampled", "sampled at the period @"),
    ("event", "event from or to the environment"),
    ("several", "another kind in each instance"),
)


def legend(vertices: Iterable[Vertex], arrows: Iterable[Arrow], width: float) -> Group | None:
    """The legend of a communication diagram."""
    return in_rows([*_boxes(list(vertices)), *_lines(list(arrows))], width)


def in_rows(entries: Sequence[Entry], width: float) -> Group | None:
    """Samples with their explanations, in rows not wider than ``width``, from the origin; None if there is nothing to
    explain.
    """
    if not entries:
        return None
    items: list[Item] = []
    x = y = 0.0
    for words, sample in entries:
        taken = SAMPLE + 7 + text_width(words, SIZE)
        if x > 0 and x + taken > width:
            x, y = 0.0, y + ROW
        text = Text(
            Point(SAMPLE + 7, ROW / 2 + (ASCENT - line_height(1) / 2) * SIZE), (TextRun(words, ink=Ink.FAINT),), SIZE
        )
        items += [moved(item, x, y) for item in (*sample, text)]
        x += taken + SPACE
    return Group("legend", tuple(items))


def _boxes(vertices: list[Vertex]) -> Iterable[Entry]:
    place = Rectangle(1, 3, SAMPLE - 2, ROW - 6)
    boxes = [vertex for vertex in vertices if isinstance(vertex, Box)]
    wanted: tuple[tuple[Callable[[Box], bool], str, Box], ...] = (
        (lambda box: box.kind == "process", "process", Box(key="", kind="process", definition="")),
        (lambda box: box.kind == "submodel", "submodel", Box(key="", kind="submodel", definition="")),
        (lambda box: box.kind == "driver", "driver", Box(key="", kind="driver", definition="")),
        (
            lambda box: box.language is not None,
            "hand-written",
            Box(key="", kind="process", definition="", language="c"),
        ),
        (lambda box: box.kind == "unknown", "unknown", Box(key="", kind="unknown", definition="")),
    )
    for occurs, words, example in wanted:
        if any(map(occurs, boxes)):
            yield words, symbols.instance(example, place)
    stores = [vertex for vertex in vertices if isinstance(vertex, Store)]
    if any(store.form != "channel" for store in stores):
        yield "variable", symbols.store(Store(key="", form="variable", type=""), place)
    if any(store.form == "channel" for store in stores):
        yield "channel", symbols.store(Store(key="", form="channel", type=""), place)
    if any(isinstance(vertex, Sink) for vertex in vertices):
        yield "discarded", symbols.sink(Rectangle(12, 3, 12, ROW - 6))


def _lines(arrows: list[Arrow]) -> Iterable[Entry]:
    begin, end = Point(0, ROW / 2), Point(SAMPLE, ROW / 2)
    drawn = {symbols.symbol_of(arrow) for arrow in arrows}
    for kind, words in _KINDS:
        if kind in drawn:
            yield words, (Line((begin, end), end=Head.ARROW), *symbols.kind_symbol(kind, begin, end))
    if any(arrow.by_composition for arrow in arrows):
        yield "by the process itself", (Line((begin, end), dash=Dash.DASHED, end=Head.ARROW),)
