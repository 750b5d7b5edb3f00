"""``cspdiag fmt``: format programs."""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace

from cspdiag.base.render.snippet import on_one_line
from cspdiag.base.report import Report
from cspdiag.base.sources import STANDARD_INPUT, FileStyle, read_whole
from cspdiag.base.span import SourceFile
from cspdiag.cli.support.difference import show_difference
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL, UsageError
from cspdiag.cli.support.files.output import replace_text
from cspdiag.cli.support.terminal import say, show_diagnostics, write_out
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse

EXAMPLE = "cspdiag fmt controller.csp\ncspdiag fmt --check --diff models/*/*.csp"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("files", nargs="+", metavar="FILE", help="a program; - reads standard input and prints")
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 if a file would change")
    parser.add_argument(
        "--diff", action="store_true", help="change nothing; print the differences, exit 1 if there are any"
    )


def run(arguments: Namespace) -> int:
    """Format every file; one with syntax errors is left as it is."""
    changes_files = not arguments.check and not arguments.diff
    for name in arguments.files:
        if changes_files and name != STANDARD_INPUT and os.path.exists(name) and not os.path.isfile(name):
            kind = (
                "a directory" if os.path.isdir(name) else "not a file that could be replaced; `fmt -` reads and prints"
            )
            raise UsageError(f"{name}: is {kind}")
    report = Report()
    changed: list[SourceFile] = []
    for source, whole in [read_whole(name) for name in dict.fromkeys(arguments.files)]:
        text = formatted(source, report)
        if text is None:
            continue
        style = FileStyle.of(whole)
        new = style.applied(text)
        if arguments.diff:
            show_difference(source, text, "formatted")
            if text == source.text and new != whole:
                say(f"would end all lines of {on_one_line(source.name)} as its first one")
        elif source.name == STANDARD_INPUT and not arguments.check:
            write_out(new)
        if new != whole:
            changed.append(source)
            _change(source, new, arguments)
    show_diagnostics(report.diagnostics, arguments.color)
    only_looked = arguments.check or arguments.diff
    return UNSUCCESSFUL if report.has_errors or (only_looked and changed) else FINE


def formatted(source: SourceFile, report: Report) -> str | None:
    """The text of a file in the standard format; None, with the reason in ``report``, if it has syntax errors."""
    own = Report()
    tree = parse(source, own)
    for diagnostic in own.diagnostics:
        report.add(diagnostic)
    return None if tree is None or own.has_errors else format_tree(tree)


def _change(source: SourceFile, text: str, arguments: Namespace) -> None:
    if arguments.check:
        say(f"would format {on_one_line(source.name)}")
    elif not arguments.diff and source.name != STANDARD_INPUT:
        replace_text(source.name, text)
        say(f"formatted {on_one_line(source.name)}")
