"""``cspdiag check``: find everything that is wrong with programs."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.report import Report
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.cli.support.diagnostic_formats import FORMATS, told_diagnostics
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL, UsageError, described
from cspdiag.cli.support.terminal import put, wants_colour, write_out
from cspdiag.pipeline import check

EXAMPLE = "cspdiag check models/jiwy/jiwy.csp\ncspdiag check --format sarif controller.csp > controller.sarif"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("files", nargs="+", metavar="FILE", help="a program; - reads standard input")
    parser.add_argument("--format", choices=FORMATS, default="text", help="how to tell what was found (default: text)")


def run(arguments: Namespace) -> int:
    """Check every file and show what was found; a file that cannot be read does not keep the others from it."""
    sources, unreadable = _read(arguments.files)
    found = Report()
    for source in sources:
        for diagnostic in check(source, read_source).report.diagnostics:
            found.add(diagnostic)
    _show(found.diagnostics, [source.name for source in sources], arguments)
    if unreadable:
        raise UsageError("; ".join(unreadable))
    return UNSUCCESSFUL if found.has_errors else FINE


def _read(names: Sequence[str]) -> tuple[list[SourceFile], list[str]]:
    """What could be read, and a sentence for each file that could not."""
    sources, unreadable = [], []
    for name in dict.fromkeys(names):
        try:
            sources.append(read_source(name))
        except OSError as problem:
            unreadable.append(described(problem))
    return sources, unreadable


def _show(diagnostics: list[Diagnostic], names: list[str], arguments: Namespace) -> None:
    colour = wants_colour(arguments.color, sys.stderr)
    stdout, stderr = told_diagnostics(diagnostics, arguments.format, names, colour=colour)
    if arguments.format == "text" and names and not diagnostics:
        files = "1 file" if len(names) == 1 else f"{len(names)} files"
        stderr = f"checked {files}: no errors\n"
    write_out(stdout)
    put(stderr)
