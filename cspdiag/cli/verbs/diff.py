"""``cspdiag diff``: the changes between two versions, in terms of the diagrams."""

from __future__ import annotations

import os
import sys
from argparse import ArgumentParser, Namespace
from typing import TYPE_CHECKING

from cspdiag.base.render.snippet import on_one_line
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL, NoResultError, UsageError
from cspdiag.cli.support.files.written import given_name, require_file, require_folder
from cspdiag.cli.support.terminal import say, show_diagnostics, wants_colour, write_out
from cspdiag.cli.support.versions.compared import Comparison, UnreadableError, all_compared, compared, versions

if TYPE_CHECKING:
    from pathlib import Path

    from cspdiag.draw.differences.programs import Difference

EXAMPLE = """cspdiag diff old.csp new.csp
cspdiag diff models/jiwy/jiwy.csp
cspdiag diff models/jiwy/jiwy.csp --from v1.0 --to main -o changes.svg
cspdiag diff HEAD~3:models/jiwy/jiwy.csp models/jiwy/jiwy.csp --format json
cspdiag diff --from main --format markdown -o changes/"""
FORMATS = (".svg", ".png", ".pdf")
UNREADABLE = 2
"""The exit code if some of a version could not be read: what was compared is not everything."""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "old",
        metavar="OLD",
        nargs="?",
        help=(
            "a program, or REVISION:FILE of a git repository; without it all programs at or below this folder that "
            "changed"
        ),
    )
    parser.add_argument(
        "new",
        metavar="NEW",
        nargs="?",
        help=(
            "the later version; without it OLD is compared with itself in two revisions: the last commit and the "
            "working tree"
        ),
    )
    parser.add_argument("--from", dest="start", metavar="REVISION", help="the earlier revision (default: HEAD)")
    parser.add_argument("--to", dest="end", metavar="REVISION", help="the later revision (default: the working tree)")
    parser.add_argument(
        "--format",
        choices=("text", "json", "markdown"),
        default="text",
        help="output format (default: text); markdown is for a comment on a change",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=given_name,
        metavar="OUT",
        help=(
            "draw the changed diagrams into a file that ends in .svg, .png or .pdf, or into a folder, a picture for "
            "each program: added green with +, removed red and broken, changed amber"
        ),
    )
    parser.add_argument(
        "--pictures",
        choices=tuple(ending.removeprefix(".") for ending in FORMATS),
        default="svg",
        help="the format of the pictures in a folder (default: svg)",
    )
    parser.add_argument(
        "--scheme", choices=("light", "dark", "auto"), default="auto", help="colours of the picture (default: auto)"
    )
    parser.add_argument("--exit-zero", action="store_true", help="exit with 0 even if there are differences")


def run(arguments: Namespace) -> int:
    """Show and draw the differences: exit code 0 for none, 1 for some, 2 if some of a version cannot be read."""
    into_folder = _check_output(arguments)
    found = _compared(arguments)
    for comparison in found:
        show_diagnostics(comparison.errors, arguments.color)
        if comparison.failure:
            say(f"cspdiag: {on_one_line(comparison.failure)}")
    pictures = _pictures(arguments, found) if into_folder else {}
    write_out(_written(arguments, found, pictures))
    if arguments.output is not None and not into_folder:
        from pathlib import Path

        _draw(Path(arguments.output), found[0].difference, arguments.scheme)
    if any(comparison.problems for comparison in found):
        return UNREADABLE
    changed = any(comparison.difference.changes for comparison in found)
    return UNSUCCESSFUL if changed and not arguments.exit_zero else FINE


def _compared(arguments: Namespace) -> list[Comparison]:
    pairs = versions(arguments)
    if arguments.old is None:
        return all_compared(pairs)
    ((before, after),) = pairs
    try:
        return [compared(before, after)]
    except UnreadableError as problem:
        show_diagnostics(problem.diagnostics, arguments.color)
        raise UsageError(str(problem)) from None


def _check_output(arguments: Namespace) -> bool:
    """Whether the pictures go into a folder. Raises UsageError for a place where none can be written."""
    output = arguments.output
    if output is None:
        return False
    is_folder = os.path.isdir(output) or output.endswith(os.sep) or not os.path.splitext(output)[1]
    if is_folder:
        require_folder("-o", output)
    elif arguments.old is None:
        raise UsageError(f"-o {output}: pictures of several programs need a folder, such as {output}{os.sep}")
    else:
        require_file("-o", output, FORMATS, any_case=True)
    return is_folder


def _written(arguments: Namespace, found: list[Comparison], pictures: dict[str, str]) -> str:
    match arguments.format:
        case "json":
            from cspdiag.draw.differences.render_json import render as render_json

            return render_json(change for comparison in found for change in comparison.difference.changes)
        case "markdown":
            from cspdiag.draw.differences.render_markdown import render as render_markdown

            sections = [
                render_markdown(
                    comparison.path,
                    comparison.difference,
                    comparison.problems,
                    pictures.get(comparison.path),
                    former="" if arguments.old is not None else comparison.former,
                )
                for comparison in found
            ]
            return "\n".join(sections)
        case _:  # text
            from cspdiag.draw.differences.render_text import render

            colour = wants_colour(arguments.color, sys.stdout)
            texts = []
            for comparison in found:
                text = render(comparison.difference.changes, colour=colour)
                text += "".join(f"  not compared: {name}\n" for name in comparison.difference.uncompared)
                heading = on_one_line(comparison.path)
                if comparison.former != comparison.path:
                    heading += f" (was {on_one_line(comparison.former)})"
                elif not text:
                    continue
                texts.append(f"{heading}\n{text}" if arguments.old is None else text)
            return "".join(texts)


def _pictures(arguments: Namespace, found: list[Comparison]) -> dict[str, str]:
    """Draw the changes of each program into a folder; the pictures by the names of the programs."""
    from pathlib import Path

    pictures: dict[str, str] = {}
    for comparison in found:
        if comparison.difference.changes:
            name = os.path.normpath(comparison.path)
            if os.path.isabs(name) or name.startswith(os.pardir):
                name = os.path.basename(name)
            path = Path(arguments.output, name).with_suffix(f".{arguments.pictures}")
            path.parent.mkdir(parents=True, exist_ok=True)
            _draw(path, comparison.difference, arguments.scheme)
            pictures[comparison.path] = path.as_posix()
    return pictures


def _draw(path: Path, difference: Difference, scheme: str) -> None:
    from cspdiag.base.files.whole import write_whole
    from cspdiag.draw.differences.picture import pictures_of
    from cspdiag.draw.layout.graph import LayoutError
    from cspdiag.draw.missing import MissingToolError
    from cspdiag.draw.output.formats import rendered

    try:
        data = rendered(pictures_of(difference), path.suffix.removeprefix(".").lower(), scheme)
    except MissingToolError as problem:
        raise UsageError(str(problem)) from None
    except LayoutError as problem:
        raise NoResultError(str(problem)) from None
    write_whole(path, data)
    say(f"wrote {on_one_line(path)}")
