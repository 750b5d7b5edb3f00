"""``cspdiag check``: find all errors in programs."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Sequence

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.report import Report
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.cli.server.memory import findings
from cspdiag.cli.support.diagnostic_formats import FORMATS, REPORTS, show_findings, unreadable
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL, UsageError, described
from cspdiag.cli.support.numbers import add_real
from cspdiag.cli.support.terminal import say, write_out

EXAMPLE = (
    "cspdiag check models/jiwy/jiwy.csp\ncspdiag check --diff controller.csp\ncspdiag check --fix controller.csp\n"
    "cspdiag check --watch controller.csp\n"
    "cspdiag check --server --format concise controller.csp\n"
    "cspdiag check --format sarif controller.csp > controller.sarif"
)


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("files", nargs="*", metavar="FILE", help="a program; - reads standard input")
    parser.add_argument(
        "--fix", action="store_true", help="fix what has exactly one sensible correction, in imported files, too"
    )
    parser.add_argument(
        "--diff", action="store_true", help="print what --fix would change, and change nothing; exit 1 if it would"
    )
    add_real(parser)
    parser.add_argument("--format", choices=FORMATS, default="text", help="output format (default: text)")
    parser.add_argument(
        "--statistics", action="store_true", help="print how often each diagnostic was found, instead of where"
    )
    parser.add_argument("--watch", action="store_true", help="check again after each change of a file, until Ctrl-C")
    # The command has looked for it before it loaded this module.
    parser.add_argument(
        "--server",
        action="store_true",
        help="have a resident server check, for editors and hooks; it is started if there is none, "
        "and ends after ten idle minutes (Linux; elsewhere without effect)",
    )
    parser.add_argument(
        "--server-status", action="store_true", help="only show whether a server is running; exit 1 if not"
    )
    parser.add_argument("--server-stop", action="store_true", help="only stop the server")


def run(arguments: Namespace) -> int:
    """Check every file and show the findings; a file that cannot be read does not prevent checking the others."""
    if arguments.server_status or arguments.server_stop:
        from cspdiag.cli.server import control

        option = "--server-stop" if arguments.server_stop else "--server-status"
        if arguments.server_status and arguments.server_stop:
            raise UsageError("--server-status and --server-stop cannot be given together")
        if arguments.files or arguments.server or arguments.fix or arguments.diff:
            raise UsageError(f"{option} checks nothing: give it without files and other options")
        return control.stop() if arguments.server_stop else control.show_status()
    if not arguments.files:
        raise UsageError("the following arguments are required: FILE (try cspdiag check --help)")
    fixes = arguments.fix or arguments.diff
    _require_combination(arguments, fixes=fixes)
    if arguments.watch:
        from cspdiag.cli.support.checking.watching import watch

        return watch(list(dict.fromkeys(arguments.files)), arguments)
    if fixes:
        from cspdiag.cli.support.checking.fixing import fix_files, require_free_output

        require_free_output(arguments)
    sources, problems = _read(arguments.files)
    if fixes:
        code = fix_files(sources, arguments)
    else:
        found = Report()
        for name, problem in problems.items() if arguments.format in REPORTS else ():
            found.add(unreadable(problem, name))
        for source in sources:
            for diagnostic in findings(source, arguments.real):
                found.add(diagnostic)
        if arguments.statistics:
            _show_statistics(found.diagnostics, arguments.format)
        else:
            show_findings(found.diagnostics, [source.name for source in sources], arguments)
        count = sum(bool(diagnostic.edits) for diagnostic in found.diagnostics)
        if count and arguments.format == "text":
            which = "it" if len(found.diagnostics) == 1 else f"{count} of them"
            say(f"--fix corrects {which}, --diff shows how")
        code = UNSUCCESSFUL if found.has_errors else FINE
    if problems:
        raise UsageError("; ".join(map(described, problems.values())))
    return code


def _require_combination(arguments: Namespace, *, fixes: bool) -> None:
    """Raise UsageError for options that contradict each other."""
    if arguments.statistics and (fixes or arguments.watch):
        raise UsageError("--statistics counts what is found once: give it without --fix, --diff and --watch")
    if arguments.statistics and arguments.format not in ("text", "json"):
        raise UsageError(f"--statistics has no format {arguments.format}: choose text or json")
    if arguments.watch and (fixes or arguments.server or "-" in arguments.files):
        raise UsageError("--watch follows files: give it without --fix, --diff, --server and -")


def _show_statistics(diagnostics: Sequence[Diagnostic], format_: str) -> None:
    from cspdiag.cli.support.checking.statistics import as_json, as_text

    write_out(as_json(diagnostics) if format_ == "json" else as_text(diagnostics))


def _read(names: Sequence[str]) -> tuple[list[SourceFile], dict[str, OSError]]:
    """What could be read, and why each other file could not."""
    sources, problems = [], {}
    for name in dict.fromkeys(names):
        try:
            sources.append(read_source(name))
        except OSError as problem:
            problems[name] = problem
    return sources, problems
