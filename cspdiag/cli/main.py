"""Finds the verb, runs it, and turns the result into an exit code.

Only the module of the present verb is imported, and only its options are built: ``cspdiag check`` has 120 ms for
everything.
"""

from __future__ import annotations

import atexit
import gc
import os
import re
import sys
from argparse import Action, ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from typing import Any, NoReturn, Protocol, cast

from cspdiag import __version__
from cspdiag.base import standard_streams
from cspdiag.cli.support.failure import (
    BROKEN_PIPE,
    FINE,
    INTERNAL_ERROR,
    INTERRUPTED,
    UNSUCCESSFUL,
    WRONG_USAGE,
    NoResultError,
    UsageError,
    described,
)
from cspdiag.cli.support.terminal import complete_streams, put, write_out

VERBS = {
    "check": "find everything that is wrong with programs",
    "compile": "generate a controller package",
    "run": "run a program against an environment",
    "devices": "show the devices that drivers can name, and what is plugged in",
    "sweep": "run a program with many values, and tabulate what is measured",
    "show": "show what a recording has",
    "verify": "prove what programs assert, or show how it fails",
    "margins": "compute the gain, phase and delay margins of the loops through the plant",
    "draw": "draw communication and composition diagrams",
    "diff": "show what changed between two versions of a program",
    "studio": "show, edit, prove and run a program in the browser",
    "fmt": "format programs",
    "explain": "show the manual page of a diagnostic",
    "new": "start a project",
    "lsp": "serve an editor by the Language Server Protocol",
    "mcp": "serve an assistant by the Model Context Protocol",
    "examples": "list the example programs, or copy one",
    "completion": "print what a shell needs to complete command lines",
    "bench": "run the benchmarks on this machine",
}
"""The verbs with what they do; each is the module ``cspdiag.cli.VERB``, a ``Verb``."""

EXAMPLE = "cspdiag run models/jiwy/jiwy.csp --plot jiwy.svg"


class Verb(Protocol):
    """The interface of a verb's module."""

    EXAMPLE: str
    """Command lines that end the verb's help."""

    def add_arguments(self, parser: ArgumentParser) -> None:
        """Declare the options."""

    def run(self, arguments: Namespace) -> int:
        """Carry the verb out and return the exit code; raises UsageError and OSError for exit code 2."""


class StoreOnce(Action):
    """Stores the value of an option; a second, different one is refused, because one of them would be lost silently."""

    _first: object = None

    def __call__(
        self, parser: ArgumentParser, namespace: Namespace, values: object, option_string: str | None = None
    ) -> None:
        """Store the value. See ``argparse.Action``."""
        if self._first is not None and self._first != values:
            parser.error(f"{option_string or self.metavar} is given twice: {self._first} and {values}")
        self._first = values
        setattr(namespace, self.dest, values)


_NEGATIVE = re.compile(r"-\.?[0-9]")


class _Parser(ArgumentParser):
    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        for name in (None, "store"):
            self.register("action", name, StoreOnce)
        # `-5s` is a value, which is then refused as such, and not an option.
        self._negative_number_matcher = _NEGATIVE

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message} (try {self.prog} --help)")

    def print_help(self, file: object = None) -> None:
        """Print the help; unlike in the base class, an error of the output is raised."""
        write_out(self.format_help())


class _HelpFormatter(RawDescriptionHelpFormatter):
    """Finds the width of the terminal without importing ``shutil``, because a formatter is made for every option."""

    def __init__(self, prog: str) -> None:
        try:
            columns = int(os.environ.get("COLUMNS", "")) or os.get_terminal_size(1).columns
        except (ValueError, OSError):
            columns = 80
        super().__init__(prog, width=max(columns - 2, 40))


def main(arguments: Sequence[str] | None = None) -> int:
    """Carry out a command line (default: that of this process) and return its exit code."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    if arguments is None:
        complete_streams()
        standard_streams.keep()
    _accept_any_character()
    code = _exit_code_of(given, whole_process=arguments is None)
    try:
        standard_streams.standard_output().flush()
    except OSError as problem:
        code = _exit_code_of_io_error(problem, code)
    if arguments is None:
        _end_at_once_if_needed(code)
    return code


def _end_at_once_if_needed(code: int) -> None:
    """Ends the process if the network still has threads of it: the interpreter, which would kill them when it shuts
    down, must not do that to a thread that is in another language; the process would be aborted, or never end.
    """
    network = sys.modules.get("cspdiag.simulate.hosts.network")
    if network is None or not network.has_threads():
        return
    atexit._run_exitfuncs()  # Those of drivers.
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):
            stream.flush()
    os._exit(code)


def _exit_code_of(given: list[str], *, whole_process: bool) -> int:
    try:
        return _dispatch(given, whole_process=whole_process)
    except UsageError as problem:
        return _refuse(str(problem))
    except NoResultError as problem:
        _refuse(str(problem), lines=True)
        return UNSUCCESSFUL
    except KeyboardInterrupt:
        return INTERRUPTED
    except OSError as problem:
        return _exit_code_of_io_error(problem, FINE)
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else FINE
    except MemoryError:
        # Reported below, where what the command had in memory is free.
        pass
    except Exception as problem:
        from cspdiag.base.render.snippet import printable
        from cspdiag.cli.support.internal import describe

        put(printable(describe(problem, given)))
        return INTERNAL_ERROR
    _refuse("the memory that this process may have is used up")
    return UNSUCCESSFUL


def verb_parser(verb: str) -> ArgumentParser:
    """The parser of a verb's options."""
    module = _module(verb)
    summary = VERBS[verb]
    examples = "\n".join(f"  {line}" for line in module.EXAMPLE.splitlines())
    parser = _Parser(
        prog=f"cspdiag {verb}",
        description=f"{summary[0].upper()}{summary[1:]}.",
        epilog=f"example:\n{examples}",
        formatter_class=_HelpFormatter,
        allow_abbrev=False,
    )
    module.add_arguments(parser)
    parser.add_argument(
        "--color", choices=("auto", "always", "never"), default="auto", help="colours (default: on a terminal)"
    )
    return parser


def _dispatch(given: list[str], *, whole_process: bool) -> int:
    if not given or given[0] in {"-h", "--help", "help"}:
        write_out(_overview())
        return FINE if given else WRONG_USAGE
    if given[0] in {"-V", "--version"}:
        write_out(f"cspdiag {__version__}\n")
        return FINE
    verb = given[0]
    if verb not in VERBS:
        raise UsageError(_unknown(verb))
    return _run(verb, given[1:], whole_process)


def _run(verb: str, options: list[str], whole_process: bool) -> int:
    """Carry out a verb; all except simulations run without garbage collection, because a compiler makes few cycles."""
    collects = gc.isenabled()
    if verb != "run":
        gc.disable()
    try:
        given = verb_parser(verb).parse_args(options, Namespace(whole_process=whole_process))
        return _module(verb).run(given)
    finally:
        if collects:
            gc.enable()
        if whole_process and verb != "run":
            # The interpreter would look for garbage twice when it ends.
            gc.freeze()


def _module(verb: str) -> Verb:
    return cast("Verb", import_module(f"cspdiag.cli.verbs.{verb}"))


def _overview() -> str:
    verbs = "\n".join(f"  {verb:<11}{summary}" for verb, summary in VERBS.items())
    return (
        "usage: cspdiag VERB [options] FILE\n\n"
        "Communication and composition diagrams in text, checked and turned into control software that runs.\n\n"
        f"verbs:\n{verbs}\n\n"
        "options:\n  --help     this page; after a verb, the page of the verb\n  --version  the version\n\n"
        f"example:\n  {EXAMPLE}\n"
    )


def _unknown(verb: str) -> str:
    from difflib import get_close_matches

    kind = "option" if verb.startswith("-") else "verb"
    near = get_close_matches(verb, VERBS, n=1)
    help_ = f"did you mean {near[0]}?" if near else "try cspdiag --help"
    return f"unknown {kind} {verb!r} ({help_})"


def _refuse(message: str, *, lines: bool = False) -> int:
    from cspdiag.base.render.snippet import on_one_line, printable

    text = printable(message) if lines else on_one_line(message)
    put(f"cspdiag: {text}\n")
    return WRONG_USAGE


def _exit_code_of_io_error(problem: OSError, code: int) -> int:
    """The exit code if something cannot be read or written; for a verb that has done its work with ``code``, that is
    its output.
    """
    _drop_broken_output()
    if isinstance(problem, BrokenPipeError):
        return code or BROKEN_PIPE
    return max(code, _refuse(described(problem)))


def _drop_broken_output() -> None:
    """The interpreter flushes standard output once more when it ends."""
    try:
        standard_streams.standard_output().flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), standard_streams.standard_output().fileno())


def _accept_any_character() -> None:
    """Let a terminal with a small character set show other characters as numbers."""
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="backslashreplace")
