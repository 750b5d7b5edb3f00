"""Scenes as PNG, by way of SVG."""

from __future__ import annotations

from math import sqrt

from cspdiag.draw.missing import missing
from cspdiag.draw.output.svg import plain_svg
from cspdiag.draw.scene.palette import Scheme
from cspdiag.draw.scene.scene_geometry import every
from cspdiag.draw.scene.shapes import Scene, Text
from cspdiag.draw.scene.text_metrics import is_measured
from cspdiag.draw.scene.typefaces import typefaces

LARGEST = 100_000_000
"""The number of pixels above which a picture is made smaller than requested; they take a few hundred megabytes."""


def render_png(scene: Scene, scheme: Scheme = Scheme.LIGHT, *, scale: float = 2.0) -> bytes:
    """The drawing with ``scale`` dots per pixel; ``Scheme.AUTO`` is light. Raises MissingToolError without
    ``cspdiag[draw]``.
    """
    try:
        from resvg_py import svg_to_bytes
    except ModuleNotFoundError:
        raise missing("resvg-py") from None
    files = typefaces()
    picture = plain_svg(scene, Scheme.LIGHT if scheme is Scheme.AUTO else scheme)
    return bytes(
        svg_to_bytes(
            svg_string=picture,
            zoom=_bounded(scene, scale),
            font_files=files,
            skip_system_fonts=bool(files) and not _is_foreign(scene),
            sans_serif_family="Arimo",
            monospace_family="Cousine",
        )
    )


def _bounded(scene: Scene, scale: float) -> float:
    largest = sqrt(LARGEST / max(scene.width * scene.height, 1))
    return min(scale, largest)


def _is_foreign(scene: Scene) -> bool:
    """Whether there are characters that the typefaces may not have: then the fonts of the machine are searched, which
    takes time.
    """
    texts = (item for item in every(scene.items) if isinstance(item, Text))
    return not all(is_measured(run.text) for text in texts for run in text.runs)
