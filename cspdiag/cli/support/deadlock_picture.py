"""Writes pictures of deadlocks, for the verbs that find them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from cspdiag.base.render.snippet import on_one_line
from cspdiag.cli.support.failure import UsageError
from cspdiag.cli.support.files.written import require_file
from cspdiag.cli.support.terminal import say

if TYPE_CHECKING:
    from cspdiag.draw.deadlock.ring import Deadlock
    from cspdiag.model.program import Program


def check_picture(option: str, path: Path) -> None:
    """Refuse a picture that could not be written, before the work instead of after it."""
    from cspdiag.draw.missing import MissingToolError
    from cspdiag.draw.output.formats import FORMATS, rendered
    from cspdiag.draw.scene.shapes import Scene

    require_file(option, path, [f".{each}" for each in FORMATS])
    try:
        rendered([Scene(1, 1, ())], path.suffix.removeprefix("."))
    except MissingToolError as problem:
        raise UsageError(f"{option} {path}: {problem}") from None


def write_picture(path: Path, deadlock: Deadlock, program: Program | None) -> None:
    """Write the picture of a deadlock; without a layout engine it has no communication diagram, and a line says so."""
    from cspdiag.base.files.whole import write_whole
    from cspdiag.draw.deadlock.ring import draw_deadlock
    from cspdiag.draw.layout.graph import LayoutError
    from cspdiag.draw.missing import MissingToolError
    from cspdiag.draw.output.formats import rendered

    try:
        scene = draw_deadlock(deadlock, program)
    except (MissingToolError, LayoutError) as problem:
        say(f"cspdiag: {on_one_line(path)} has no communication diagram: {problem}")
        scene = draw_deadlock(deadlock)
    write_whole(path, rendered([scene], path.suffix.removeprefix(".")))
