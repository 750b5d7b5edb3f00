"""A program as a notebook shows it."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from cspdiag.draw.output.svg import render_svg
from cspdiag.draw.pictures import Pictures

if TYPE_CHECKING:
    from collections.abc import Sequence

    from cspdiag.base import Diagnostic
    from cspdiag.model.program import Program


def notebook(program: Program | None, found: Sequence[Diagnostic]) -> str | None:
    """The messages about a program and its diagrams, those of the outermost process unfolded; None if there is nothing
    to show.

    ``program`` is None if it cannot be read. A program with errors is drawn as far as it can be read, with marks.
    Raises the same exceptions as ``lay_out``.
    """
    from cspdiag.base.render.text import render

    parts = [f"<pre>{escape(render(found))}</pre>"] if found else []
    if program is not None:
        pictures = Pictures(program, found)
        outermost = pictures.outermost()
        drawn = pictures.drawn()
        for definition in sorted(drawn, key=lambda each: each is not outermost):
            unfolded = " open" if definition is outermost else ""
            drawing = render_svg(pictures.scene(definition))
            parts.append(f"<details{unfolded}><summary>{escape(definition.name.text)}</summary>\n{drawing}</details>")
    return "\n".join(parts) or None
