"""The typefaces with which PNG and PDF are made, so that they look the same on every machine."""

from __future__ import annotations

from cspdiag.base.files import resources
from cspdiag.draw.scene.shapes import Face

_FILES = {
    Face.SANS: "Arimo-Regular.ttf",
    Face.BOLD: "Arimo-Bold.ttf",
    Face.ITALIC: "Arimo-Italic.ttf",
    Face.MONO: "Cousine-Regular.ttf",
}


def typeface(face: Face) -> str | None:
    """The path of a typeface's file; None if it was not fetched."""
    return resources.third_party("fonts", _FILES[face])


def typefaces() -> list[str]:
    """The paths of all typefaces that are installed."""
    return [path for face in Face if (path := typeface(face)) is not None]
