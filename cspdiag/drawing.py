"""A picture as Python programs and notebooks have it."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from cspdiag.arguments import number_of, require_one_of, shown
from cspdiag.base.errors import ArgumentError, file_errors

if TYPE_CHECKING:
    from cspdiag.draw.scene.shapes import Scene


class Drawing:
    """A picture; a notebook shows it."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

    def __repr__(self) -> str:
        return f"<Drawing of {self.scene.title}>"

    def _repr_svg_(self) -> str:
        return self.svg()

    def svg(self, scheme: str = "auto") -> str:
        """The picture as SVG, in the colours of the scheme ``light``, ``dark`` or, as the viewer prefers, ``auto``.

        Raises ArgumentError for another scheme.
        """
        from cspdiag.draw.output.svg import render_svg
        from cspdiag.draw.scene.palette import Scheme

        require_one_of("scheme", scheme, [each.value for each in Scheme])
        return render_svg(self.scene, Scheme(scheme))

    def save(self, path: str | os.PathLike[str], *, scheme: str = "auto", scale: float = 2.0) -> None:
        """Write a file whose name ends in ``.svg``, ``.png`` (``scale`` dots per pixel) or ``.pdf``.

        Raises ArgumentError for another ending, scheme or scale, FileError if it cannot be written.
        """
        from pathlib import Path

        from cspdiag.base.files.whole import write_whole
        from cspdiag.draw.output.formats import FORMATS, rendered
        from cspdiag.draw.scene.palette import Scheme

        suffix = Path(path).suffix.removeprefix(".").lower()
        require_one_of("ending of a picture", suffix, FORMATS)
        require_one_of("scheme", scheme, [each.value for each in Scheme])
        if not 0.1 <= number_of("scale", scale) <= 20:
            raise ArgumentError(f"scale is between 0.1 and 20, not {shown(scale)}")
        with file_errors():
            write_whole(Path(path), rendered([self.scene], suffix, scheme, scale))
