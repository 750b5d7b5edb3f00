"""Diagnostics in each of the formats of ``check`` and ``verify``."""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Sequence

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.span import SourceFile, Span
from cspdiag.cli.support.failure import reason_of
from cspdiag.cli.support.terminal import put, wants_colour, write_out

FORMATS = ("text", "concise", "json", "sarif", "github", "junit")
REPORTS = frozenset({"json", "sarif", "github", "junit"})
"""Formats for other programs, which see only what is in the report."""


def unreadable(problem: OSError, name: str) -> Diagnostic:
    """That a file of the command line cannot be read, for a report; people read it as the failure of the command."""
    from cspdiag.model.diagnostics.imports import UnreadableFile

    missing = isinstance(problem, FileNotFoundError)
    place = Span(SourceFile(name=name, text=""), 0, 0)
    return UnreadableFile(place, path=None, file=name, missing=missing, reason=reason_of(problem))


def rendered_diagnostics(
    diagnostics: Sequence[Diagnostic], format_: str, files: Sequence[str], *, colour: bool
) -> tuple[str, str]:
    """The texts for standard output and for standard error; ``files`` are those that were examined."""
    match format_:
        case "concise":
            from cspdiag.base.render.concise import render as render_concise

            return "", render_concise(diagnostics)
        case "json":
            from cspdiag.base.render.json import render as render_json

            return render_json(diagnostics), ""
        case "sarif":
            from cspdiag.base.render.sarif import render as render_sarif

            return render_sarif(diagnostics), ""
        case "github":
            from cspdiag.base.render.github import render as render_github

            return render_github(diagnostics), ""
        case "junit":
            from cspdiag.base.render.junit import render as render_junit

            return render_junit(diagnostics, files), ""
        case "text":
            from cspdiag.base.render.text import render as render_text

            return "", render_text(diagnostics, colour=colour) if diagnostics else ""
        case _:
            raise AssertionError(f"diagnostics have no format {format_!r}")


def show_findings(diagnostics: Sequence[Diagnostic], names: Sequence[str], arguments: Namespace) -> None:
    """Show the findings in files in the requested format and colours, or that there are none."""
    colour = wants_colour(arguments.color, sys.stderr)
    stdout, stderr = rendered_diagnostics(diagnostics, arguments.format, names, colour=colour)
    if arguments.format == "text" and names and not diagnostics:
        files = "1 file" if len(names) == 1 else f"{len(names)} files"
        stderr = f"checked {files}: no errors\n"
    write_out(stdout)
    put(stderr)
