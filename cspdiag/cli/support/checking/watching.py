"""``check --watch``: check again whenever a file of the programs changes."""

from __future__ import annotations

import sys
import time
from argparse import Namespace
from collections.abc import Iterable, Sequence

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.files.content import Stamp, stamp_of_file
from cspdiag.base.report import Report
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.cli.support.diagnostic_formats import show_findings
from cspdiag.cli.support.failure import described
from cspdiag.cli.support.terminal import put, say, write_out
from cspdiag.network.lower.external_bodies import files_of_bodies
from cspdiag.pipeline import check

INTERVAL = 0.2
"""Seconds between two looks at the files. Their times are read, which costs little and works on every file system."""

_CLEAR = "\x1b[2J\x1b[3J\x1b[H"


def watch(names: Sequence[str], arguments: Namespace) -> int:
    """Check the files now and after each change of one of them or of a file that they import or name as a body, until
    Ctrl-C.
    """
    while True:
        seen = _check_once(names, arguments)
        before = stamps(seen)
        while stamps(seen) == before:
            time.sleep(INTERVAL)


def _check_once(names: Sequence[str], arguments: Namespace) -> set[str]:
    """Show the findings; returns the files to look at."""
    if sys.stdout.isatty():
        write_out(_CLEAR)
    seen = set(names)

    def read(name: str) -> SourceFile:
        seen.add(name)
        return read_source(name)

    found, checked = Report(), []
    for name in names:
        try:
            source = read(name)
        except OSError as problem:
            put(f"{described(problem)}\n")
            continue
        checked.append(name)
        program = check(source, read, for_findings=True, real=arguments.real)
        for diagnostic in program.report.diagnostics:
            found.add(diagnostic)
        for tree in () if program.readable is None else program.readable.trees:
            seen.update(files_of_bodies(tree))
    show_findings(found.diagnostics, checked, arguments)
    unread = len(names) - len(checked)
    summary = _summary(found.diagnostics) + (f", {_files(unread)} not checked" if unread else "")
    say(f"{time.strftime('%H:%M:%S')} {summary}; watching {_files(len(seen))}, Ctrl-C ends")
    return seen


def _summary(diagnostics: Sequence[Diagnostic]) -> str:
    errors = sum(diagnostic.severity == "error" for diagnostic in diagnostics)
    warnings = len(diagnostics) - errors
    return f"{errors} error{'s' * (errors != 1)}, {warnings} warning{'s' * (warnings != 1)}"


def _files(count: int) -> str:
    return f"{count} file{'s' * (count != 1)}"


def stamps(names: Iterable[str]) -> dict[str, Stamp | None]:
    """What changes with the content of each file; None for a file that is not there."""
    return {name: stamp_of_file(name) for name in names}
