"""The colours of light and dark drawings, and the typefaces.

Words and lines have a contrast of at least 4.5 to 1 with their background in both schemes (WCAG 2.2, 1.4.3); no
information is given by colour alone.
"""

from __future__ import annotations

from enum import Enum

from cspdiag.draw.scene.shapes import Dash, Face, Ink


class Scheme(Enum):
    """The colours of a drawing."""

    LIGHT = "light"
    DARK = "dark"
    AUTO = "auto"
    """As the viewer prefers; light on paper."""


LIGHT: dict[Ink, str] = {
    Ink.PAPER: "#ffffff",
    Ink.LINE: "#3f4752",
    Ink.TEXT: "#1c2128",
    Ink.FAINT: "#5b6470",
    Ink.BORDER: "#515a66",
    Ink.PROCESS: "#f5f7f9",
    Ink.SUBMODEL: "#eaf2fb",
    Ink.VARIABLE: "#fbf5e2",
    Ink.FRAME: "#fcfdfe",
    Ink.ACCENT: "#0a5fc2",
    Ink.ERROR: "#c4222d",
    Ink.WARNING: "#8f5f00",
    Ink.ADDED: "#187537",
    Ink.REMOVED: "#c4222d",
    Ink.CHANGED: "#8f5f00",
    Ink.ERROR_FILL: "#fdecec",
    Ink.WARNING_FILL: "#fff4d6",
    Ink.ADDED_FILL: "#e3f6e8",
    Ink.REMOVED_FILL: "#fdecec",
    Ink.CHANGED_FILL: "#fff4d6",
    Ink.ACCENT_FILL: "#e6f0fd",
}

DARK: dict[Ink, str] = {
    Ink.PAPER: "#0f1419",
    Ink.LINE: "#b4bdc8",
    Ink.TEXT: "#e8edf2",
    Ink.FAINT: "#9aa4af",
    Ink.BORDER: "#97a1ad",
    Ink.PROCESS: "#1b222b",
    Ink.SUBMODEL: "#14283f",
    Ink.VARIABLE: "#2e2812",
    Ink.FRAME: "#141a21",
    Ink.ACCENT: "#6cb0ff",
    Ink.ERROR: "#ff8078",
    Ink.WARNING: "#e5b545",
    Ink.ADDED: "#5fd47a",
    Ink.REMOVED: "#ff8078",
    Ink.CHANGED: "#e5b545",
    Ink.ERROR_FILL: "#3c1a1d",
    Ink.WARNING_FILL: "#372b0b",
    Ink.ADDED_FILL: "#12301c",
    Ink.REMOVED_FILL: "#3c1a1d",
    Ink.CHANGED_FILL: "#372b0b",
    Ink.ACCENT_FILL: "#14305a",
}

SANS = "Helvetica, Arial, 'Liberation Sans', Arimo, sans-serif"
MONO = "Menlo, 'Liberation Mono', Cousine, 'DejaVu Sans Mono', 'Courier New', monospace"

DASHES: dict[Dash, tuple[float, ...]] = {
    Dash.SOLID: (),
    Dash.DASHED: (6, 4),
    Dash.DOTTED: (1.4, 3.4),
    Dash.DASH_DOTTED: (8, 3, 1.4, 3),
}
"""Lengths of strokes and gaps in turn, in pixels."""


def colours(scheme: Scheme) -> dict[Ink, str]:
    """The colours of a scheme by ink, as ``#rrggbb``."""
    return DARK if scheme is Scheme.DARK else LIGHT


def family(face: Face) -> str:
    """The typefaces to try, in order."""
    return MONO if face is Face.MONO else SANS
