"""Drawings in the formats of files."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.base.record import replaced
from cspdiag.draw.scene.palette import Scheme
from cspdiag.draw.scene.scene_geometry import stacked
from cspdiag.draw.scene.shapes import Scene

FORMATS = ("svg", "png", "pdf")


def rendered(scenes: Sequence[Scene], format_: str, scheme: str = "auto", scale: float = 2.0) -> bytes:
    """One picture of the scenes, below each other; in a PDF, each has its own page. ``scale`` is in dots per pixel, for
    PNG. Raises ValueError for another format, MissingToolError without ``cspdiag[draw]``.
    """
    colours = Scheme(scheme)
    match format_:
        case "pdf":
            from cspdiag.draw.output.pdf import render_pdf

            return render_pdf(scenes, colours)
        case "png":
            from cspdiag.draw.output.png import render_png

            return render_png(_whole(scenes), colours, scale=scale)
        case "svg":
            from cspdiag.draw.output.svg import render_svg

            return render_svg(_whole(scenes), colours).encode()
        case _:
            raise ValueError(f"a picture is {', '.join(FORMATS)}, not {format_!r}")


def _whole(scenes: Sequence[Scene]) -> Scene:
    if len(scenes) == 1:
        return scenes[0]
    return replaced(stacked(scenes), title=", ".join(scene.title for scene in scenes), description="")
