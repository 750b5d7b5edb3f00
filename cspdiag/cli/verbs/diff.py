"""``cspdiag diff``: the changes between two versions, in terms of the diagrams."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from typing import TYPE_CHECKING

from cspdiag.base.render.snippet import on_one_line
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL, NoResultError, UsageError
from cspdiag.cli.support.files.written import file_path, require_file
from cspdiag.cli.support.revisions import LAST_COMMIT, reader_of, split_name
from cspdiag.cli.support.terminal import say, show_diagnostics, wants_colour, write_out
from cspdiag.pipeline import check

if TYPE_CHECKING:
    from cspdiag.draw.differences.programs import Difference
    from cspdiag.model.program import Program

EXAMPLE = """cspdiag diff old.csp new.csp
cspdiag diff models/jiwy/jiwy.csp
cspdiag diff models/jiwy/jiwy.csp --from v1.0 --to main -o changes.svg
cspdiag diff HEAD~3:models/jiwy/jiwy.csp models/jiwy/jiwy.csp --format json"""
FORMATS = (".svg", ".png", ".pdf")


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("old", metavar="OLD", help="a program, or REVISION:FILE of a git repository")
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
    parser.add_argument("--format", choices=("text", "json"), default="text", help="output format (default: text)")
    parser.add_argument(
        "-o",
        "--output",
        metavar="OUT",
        type=file_path,
        help=(
            "draw the changed diagrams into a file that ends in .svg, .png or .pdf: added green with +, removed red "
            "and broken, changed amber"
        ),
    )
    parser.add_argument(
        "--scheme", choices=("light", "dark", "auto"), default="auto", help="colours of the picture (default: auto)"
    )
    parser.add_argument("--exit-zero", action="store_true", help="exit with 0 even if there are differences")


def run(arguments: Namespace) -> int:
    """Show and draw the differences: exit code 0 for none, 1 for some, 2 if a version cannot be read."""
    require_file("-o", arguments.output, FORMATS, any_case=True)
    versions = _versions(arguments)
    before, after = (_program(revision, path, arguments) for revision, path in versions)

    from cspdiag.draw.differences.programs import differences

    found = differences(before, after)
    if arguments.format == "json":
        from cspdiag.draw.differences.render_json import render as render_json

        write_out(render_json(found.changes))
    else:
        from cspdiag.draw.differences.render_text import render

        write_out(render(found.changes, colour=wants_colour(arguments.color, sys.stdout)))
    if arguments.output is not None:
        _draw(arguments, found)
    return UNSUCCESSFUL if found.changes and not arguments.exit_zero else FINE


def _versions(arguments: Namespace) -> tuple[tuple[str | None, str], tuple[str | None, str]]:
    """Revision and file of both versions."""
    if arguments.new is not None:
        if arguments.start is not None or arguments.end is not None:
            raise UsageError("--from and --to are for the revisions of one file")
        return split_name(arguments.old), split_name(arguments.new)
    revision, path = split_name(arguments.old)
    if revision is not None:
        if arguments.start is not None:
            raise UsageError(f"{arguments.old} names a revision, and so does --from")
        return (revision, path), (arguments.end, path)
    return (arguments.start or LAST_COMMIT, path), (arguments.end, path)


def _program(revision: str | None, path: str, arguments: Namespace) -> Program:
    read = reader_of(revision)
    checked = check(read(path), read)
    if checked.program is None:
        show_diagnostics(checked.report.diagnostics, arguments.color)
        raise UsageError(f"{path}{f' in {revision}' if revision else ''} cannot be read as a program")
    return checked.program


def _draw(arguments: Namespace, found: Difference) -> None:
    from cspdiag.base.files.whole import write_whole
    from cspdiag.draw.differences.picture import pictures_of
    from cspdiag.draw.layout.graph import LayoutError
    from cspdiag.draw.missing import MissingToolError
    from cspdiag.draw.output.formats import rendered

    try:
        scenes = pictures_of(found)
        data = rendered(scenes, arguments.output.suffix.removeprefix(".").lower(), arguments.scheme)
    except MissingToolError as problem:
        raise UsageError(str(problem)) from None
    except LayoutError as problem:
        raise NoResultError(str(problem)) from None
    write_whole(arguments.output, data)
    say(f"wrote {on_one_line(arguments.output)}")
