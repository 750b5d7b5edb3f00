"""Rules for every drawing: no line runs through words, no words overlap or leave the sheet, no symbol of an arrow lies
on another arrow, and no arrow on the side of a box.
"""

from __future__ import annotations

from itertools import combinations

from cspdiag.draw.scene.geometry import Rectangle
from cspdiag.draw.scene.scene_geometry import bounds, every
from cspdiag.draw.scene.shapes import Box, Ellipse, Group, Item, Scene, Text
from cspdiag.draw.scene.text_metrics import CAPITAL, runs_width
from tests.draw.geometry.arrows import sides_run_along, symbol_faults
from tests.draw.geometry.segments import crosses, stroked


def faults(scene: Scene) -> list[str]:
    """What is wrong with a drawing, in words; empty if nothing is wrong."""
    items = list(every(scene.items))
    texts = [(index, item) for index, item in enumerate(items) if isinstance(item, Text) and words(item)]
    found = [
        f"{words(first)!r} lies on {words(second)!r}"
        for (_, first), (_, second) in combinations(texts, 2)
        if ink(first).overlaps(ink(second))
    ]
    strokes = [(index, segment) for index, item in enumerate(items) for segment in stroked(item)]
    for index, text in texts:
        place = ink(text)
        paper = max((i for i, item in enumerate(items[:index]) if _covers(item, place)), default=-1)
        found += [
            f"a line from {first} to {second} runs through {words(text)!r}"
            for i, (first, second) in strokes
            if i >= paper and crosses(place, first, second)
        ]
    sheet = Rectangle(0, 0, scene.width, scene.height)
    found += [
        f"{item} leaves the sheet" for item in scene.items if not _is_empty(item) and not sheet.contains(bounds(item))
    ]
    return [*found, *_hidden(items), *symbol_faults(scene), *sides_run_along(scene)]


def _covers(item: Item, place: Rectangle) -> bool:
    """Whether an item hides what was drawn in a place before."""
    return isinstance(item, Box) and item.fill is not None and item.place.contains(place)


def words(text: Text) -> str:
    return "".join(run.text for run in text.runs)


def ink(text: Text) -> Rectangle:
    """The area of the capitals and small letters of a text, without that of possible descenders and accents."""
    width = runs_width(text.runs, text.size)
    left = text.at.x - {"start": 0.0, "middle": width / 2, "end": width}[text.anchor.value]
    return Rectangle(left, text.at.y - CAPITAL * text.size, width, CAPITAL * text.size)


def _hidden(items: list[Item]) -> list[str]:
    """Texts that something filled is drawn over."""
    found = []
    for index, text in enumerate(items):
        if not isinstance(text, Text) or not words(text):
            continue
        for later in items[index + 1 :]:
            if isinstance(later, Box | Ellipse) and later.fill and ink(text).overlaps(later.place):
                found.append(f"{words(text)!r} is covered by {later}")
    return found


def _is_empty(item: Item) -> bool:
    return isinstance(item, Group) and not any(not isinstance(each, Group) for each in every(item.items))
