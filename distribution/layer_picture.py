"""Draws the picture of the layers in docs/architecture.md from the import rules and the imports.

``--check`` only reports whether it is out of date.

python distribution/layer_picture.py [--check]
"""

from __future__ import annotations

import sys
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import grimp

from cspdiag.draw.output.svg import render_svg
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.scene_geometry import fitted
from cspdiag.draw.scene.shapes import Anchor, Box, Ellipse, Face, Ink, Item, Line, Scene, Text, TextRun

ROOT = Path(__file__).parent.parent
PICTURE = ROOT / "docs" / "pictures" / "layers.svg"
PACKAGE = "cspdiag"
ROW = 26.0
NAMES = 112.0
"""The width of the names, left of the matrix."""
TYPING = {"typing_extensions"}
"""What type checkers know without an installation, and nothing loads."""


@dataclass(frozen=True)
class Layers:
    """``levels`` from the top, each with the layers that are independent of each other.

    The pairs are importer and imported layer.
    """

    levels: tuple[tuple[str, ...], ...]
    imports: frozenset[tuple[str, str]]
    forbidden: frozenset[tuple[str, str]]
    libraries: dict[str, tuple[str, ...]]
    """Third-party packages, by the layers that import them; without the standard library."""

    @property
    def names(self) -> list[str]:
        """All layers, from the top."""
        return [name for level in self.levels for name in level]

    def last_beside(self, name: str) -> int:
        """The number of layers above a layer or on its level, including itself."""
        (level,) = (level for level in self.levels if name in level)
        return self.names.index(level[-1]) + 1


def read_layers() -> Layers:
    """The layers from pyproject.toml, and what they import, including imports in functions and for types."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    (order,) = (contract for contract in contracts if contract["type"] == "layers")
    levels = tuple(tuple(part.strip(" ()") for part in level.split("|")) for level in order["layers"])
    graph = grimp.build_graph(PACKAGE, include_external_packages=True, cache_dir=None)
    imports, libraries = set(), defaultdict(set)
    names = {name for level in levels for name in level}
    for importer in graph.modules:
        layer = _layer(importer)
        if layer not in names:
            continue
        for imported in graph.find_modules_directly_imported_by(importer):
            root = imported.partition(".")[0]
            if root == PACKAGE:
                imports.add((layer, _layer(imported)))
            elif root not in sys.stdlib_module_names | TYPING:
                libraries[layer].add(root)
    return Layers(
        levels,
        frozenset(pair for pair in imports if pair[0] != pair[1] and pair[1] in names),
        frozenset(_forbidden(contracts)),
        {layer: tuple(sorted(found)) for layer, found in libraries.items()},
    )


def _layer(module: str) -> str:
    return module.split(".")[1] if "." in module else ""


def _is_layer(module: str) -> bool:
    return module.startswith(f"{PACKAGE}.") and module.count(".") == 1


def _forbidden(contracts: list[dict[str, Any]]) -> Iterator[tuple[str, str]]:
    """The pairs of entire layers of which the first must not import the second; rules about parts of one are
    left out.
    """
    for contract in contracts:
        match contract["type"]:
            case "forbidden":
                pairs = product(contract["source_modules"], contract["forbidden_modules"])
            case "independence":
                pairs = product(contract["modules"], repeat=2)
            case _:
                continue
        for source, other in pairs:
            if source != other and _is_layer(source) and _is_layer(other):
                yield _layer(source), _layer(other)


def draw(layers: Layers) -> Scene:
    """A row and a column for each layer; what is to the left of the steps can never be imported."""
    names = layers.names
    right = NAMES + len(names) * ROW
    items: list[Item] = [_text(right + 14, 0, "third-party libraries", Ink.FAINT)]
    for index, name in enumerate(names):
        y = (index + 1) * ROW
        items += [
            Box(Rectangle(NAMES, y, layers.last_beside(name) * ROW, ROW), fill=Ink.ACCENT_FILL, stroke=None),
            _text(0, y, str(index + 1), Ink.FAINT),
            _text(24, y, name, face=Face.BOLD),
            _text(NAMES + (index + 0.5) * ROW, 0, str(index + 1), Ink.FAINT, Anchor.MIDDLE),
            _text(right + 14, y, ", ".join(layers.libraries.get(name, ())), face=Face.MONO),
        ]
        for column, other in enumerate(names):
            x = NAMES + column * ROW
            if (name, other) in layers.imports:
                ink = Ink.ERROR if column < layers.last_beside(name) else Ink.LINE
                items.append(Ellipse(Rectangle(x + ROW / 2 - 4, y + ROW / 2 - 4, 8, 8), fill=ink, stroke=None))
            elif column >= layers.last_beside(name) and (name, other) in layers.forbidden:
                items += _cross(x + ROW / 2, y + ROW / 2)
    lines, y = [ROW], ROW
    for level in layers.levels:
        y += len(level) * ROW
        lines.append(y)
    items += [Line((Point(0, y), Point(right, y)), stroke=Ink.FAINT, width=0.6) for y in lines]
    return fitted([*items, *_legend(y + ROW / 2)], title="The layers of cspdiag", name="layers")


def _legend(y: float) -> list[Item]:
    return [
        Ellipse(Rectangle(2, y + ROW / 2 - 4, 8, 8), fill=Ink.LINE, stroke=None),
        _text(18, y, "imports", Ink.FAINT),
        *_cross(90, y + ROW / 2),
        _text(102, y, "below it, but must not be imported", Ink.FAINT),
        Box(Rectangle(312, y + 5, 16, 16), fill=Ink.ACCENT_FILL, stroke=None),
        _text(336, y, "above it or on its level: never imported", Ink.FAINT),
    ]


def _cross(x: float, y: float) -> list[Item]:
    return [Line((Point(x - 4, y - step), Point(x + 4, y + step)), stroke=Ink.ERROR, width=1.6) for step in (4.0, -4.0)]


def _text(
    x: float, y: float, words: str, ink: Ink = Ink.TEXT, anchor: Anchor = Anchor.START, face: Face = Face.SANS
) -> Text:
    return Text(Point(x, y + ROW / 2 + 4.5), (TextRun(words, face, ink),), 12, anchor)


def picture() -> str:
    """The picture as SVG."""
    return render_svg(draw(read_layers()))


def main(arguments: list[str]) -> int:
    """Write the picture, or check it; returns 1 if it is out of date."""
    text = picture()
    if PICTURE.exists() and PICTURE.read_text(encoding="utf-8") == text:
        return 0
    if "--check" in arguments:
        print(f"{PICTURE.relative_to(ROOT)} is out of date: make pictures")
        return 1
    PICTURE.write_text(text, encoding="utf-8")
    print(f"wrote {PICTURE.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
