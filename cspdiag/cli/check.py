"""``cspdiag check``: find everything that is wrong with programs."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace

from cspdiag.cli.failure import FINE, UNSUCCESSFUL
from cspdiag.cli.terminal import show_diagnostics
from cspdiag.diagnostics.diagnostic import Diagnostic
from cspdiag.diagnostics.report import Report
from cspdiag.pipeline import check
from cspdiag.sources import read_source

EXAMPLE = "cspdiag check models/jiwy/jiwy.csp\ncspdiag check --format sarif controller.csp > controller.sarif"
FORMATS = ("text", "concise", "json", "sarif", "github", "junit")


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("files", nargs="+", metavar="FILE", help="a program; - reads standard input")
    parser.add_argument("--format", choices=FORMATS, default="text", help="how to tell what was found (default: text)")


def run(arguments: Namespace) -> int:
    """Check every file and show what was found."""
    sources = [read_source(name) for name in dict.fromkeys(arguments.files)]
    found = Report()
    for source in sources:
        for diagnostic in check(source, read_source).report.diagnostics:
            found.add(diagnostic)
    _show(found.diagnostics, [source.name for source in sources], arguments)
    return UNSUCCESSFUL if found.has_errors else FINE


def _show(diagnostics: list[Diagnostic], names: list[str], arguments: Namespace) -> None:
    match arguments.format:
        case "text":
            show_diagnostics(diagnostics, arguments.color)
            if not diagnostics:
                files = "1 file" if len(names) == 1 else f"{len(names)} files"
                sys.stderr.write(f"checked {files}: no errors\n")
        case "concise":
            from cspdiag.diagnostics.render_concise import render as render_concise

            sys.stderr.write(render_concise(diagnostics))
        case "json":
            from cspdiag.diagnostics.render_json import render as render_json

            sys.stdout.write(render_json(diagnostics))
        case "sarif":
            from cspdiag.diagnostics.render_sarif import render as render_sarif

            sys.stdout.write(render_sarif(diagnostics))
        case "github":
            from cspdiag.diagnostics.render_github import render as render_github

            sys.stdout.write(render_github(diagnostics))
        case "junit":
            from cspdiag.diagnostics.render_junit import render as render_junit

            sys.stdout.write(render_junit(diagnostics, names))
