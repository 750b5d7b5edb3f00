"""The picture of the layers agrees with the import rules and the imports."""

from __future__ import annotations

from cspdiag.draw.scene.scene_geometry import every
from cspdiag.draw.scene.shapes import Ellipse, Ink
from distribution.layer_picture import PICTURE, Layers, draw, picture, read_layers


def test_the_picture_is_current() -> None:
    assert PICTURE.read_text(encoding="utf-8") == picture(), "make pictures"


def test_what_is_imported_and_what_must_not_be_is_read_from_the_code() -> None:
    layers = read_layers()
    assert (layers.names[0], layers.names[-1]) == ("cli", "base")
    assert ("cli", "pipeline") in layers.imports, "in functions, too"
    assert ("network", "runtime") in layers.forbidden
    assert ("semantics", "runtime") in layers.forbidden, "they are independent"
    assert not layers.imports & layers.forbidden
    assert layers.libraries["syntax"] == ("lark",)
    assert layers.libraries["network"] == ("control", "numpy"), "and nothing for type checkers"


def dots(layers: Layers) -> list[Ink | None]:
    return [item.fill for item in every(draw(layers).items) if isinstance(item, Ellipse)][:-1]


def test_an_import_upwards_would_be_red() -> None:
    levels = (("top",), ("left", "right"), ("base",))
    assert dots(Layers(levels, frozenset({("top", "base")}), frozenset(), {})) == [Ink.LINE]
    assert dots(Layers(levels, frozenset({("base", "top")}), frozenset(), {})) == [Ink.ERROR]
    assert dots(Layers(levels, frozenset({("left", "right")}), frozenset(), {})) == [Ink.ERROR]
