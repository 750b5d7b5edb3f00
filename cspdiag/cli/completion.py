"""Answers a shell that completes a command line, by argcomplete; ``cspdiag completion`` prints what the shell needs.

Options and choices come from the parsers of the verbs, names of environments, processes and settings from the program
that the line names. Protocol: https://kislyuk.github.io/argcomplete.
"""

from __future__ import annotations

import os
import shlex
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from cspdiag.model.program import Program

Completer: TypeAlias = "Callable[..., Iterable[str]]"
"""Called with ``prefix``, ``action``, ``parser`` and ``parsed_args``."""

_MOST_SETTINGS = 500
"""A program may have too many parameters to list them all."""


def complete() -> None:
    """Write the completions of the line in the environment variable COMP_LINE for the shell, and end the process."""
    import argcomplete
    from argcomplete.finders import safe_actions

    from cspdiag.cli.main import StoreOnce

    # Only actions without side effects are carried out, so that completers know what the line has given so far.
    safe_actions.add(StoreOnce)
    parser = line_parser(os.environ.get("COMP_LINE", ""))
    argcomplete.autocomplete(parser, always_complete_options="long")


def line_parser(line: str) -> ArgumentParser:
    """A parser of all verbs, of which only the one in ``line`` has its options."""
    from cspdiag.cli.main import VERBS, verb_parser

    words = _words(line)
    parser = ArgumentParser(prog="cspdiag", add_help=False)
    parser.add_argument("--help", action="store_true", help="what cspdiag does")
    parser.add_argument("--version", action="store_true", help="the version")
    verbs = parser.add_subparsers(metavar="VERB")
    for verb, summary in VERBS.items():
        if verb in words:
            own = verb_parser(verb)
            _add_completers(own)
            verbs.add_parser(verb, help=summary, parents=[own], add_help=False)
        else:
            verbs.add_parser(verb, help=summary)
    return parser


def _words(line: str) -> list[str]:
    """The words of a line that may end inside quotes."""
    for closing in ("", "'", '"'):
        try:
            return shlex.split(line + closing)
        except ValueError:
            continue
    return line.split()


def _add_completers(parser: ArgumentParser) -> None:
    from argcomplete.completers import FilesCompleter

    programs: Completer = FilesCompleter(allowednames=("csp",))
    positional = {"FILE": programs, "OLD": programs, "NEW": programs, "CODE": codes, "DEVICE": devices}
    everywhere: dict[str, Completer] = {"EXAMPLE": examples, "REVISION": revisions}
    for action in parser._actions:
        if str(action.metavar) in everywhere:
            completer: Completer | None = everywhere[str(action.metavar)]
        elif action.option_strings:
            completer = _OF_OPTIONS.get(action.option_strings[-1])
        else:
            completer = positional.get(str(action.metavar)) if parser.prog != "cspdiag show" else None
        if completer is not None:
            action.completer = completer  # type: ignore[attr-defined]


def environments(parsed_args: Namespace, **_: object) -> list[str]:
    """The names of the environments of the program."""
    from cspdiag.syntax import ast

    return [item.name.text for item in _definitions(parsed_args) if isinstance(item, ast.EnvironmentDefinition)]


def processes(parsed_args: Namespace, **_: object) -> list[str]:
    """The names of the processes of the program."""
    from cspdiag.syntax import ast

    return [item.name.text for item in _definitions(parsed_args) if isinstance(item, ast.ProcessDefinition)]


def drawings(parsed_args: Namespace, **_: object) -> list[str]:
    """The names of what can be drawn: processes and environments."""
    return [*processes(parsed_args), *environments(parsed_args)]


def settings(parsed_args: Namespace, **_: object) -> list[str]:
    """What ``--set`` may set, each with an equals sign: constants and their fields, parameters by their paths."""
    program = _program(parsed_args)
    return [] if program is None else [f"{name}=" for name in islice(_settable(program), _MOST_SETTINGS)]


def codes(**_: object) -> list[str]:
    """The codes of the diagnostics."""
    from cspdiag.base.manual import manual_pages

    return list(manual_pages())


def devices(**_: object) -> list[str]:
    """The names of the devices."""
    from cspdiag.devices.catalogue import DEVICES

    return list(DEVICES)


def examples(**_: object) -> list[str]:
    """The names of the examples."""
    from cspdiag.base.files.examples import summaries

    return list(summaries())


def revisions(**_: object) -> list[str]:
    """The branches and tags of the git repository; none outside of one."""
    from cspdiag.cli.support.failure import UsageError
    from cspdiag.cli.support.versions.revisions import LAST_COMMIT, git

    try:
        found = git(os.curdir, os.curdir, "for-each-ref", "--format=%(refname:short)")
    except UsageError:
        return []
    return [LAST_COMMIT, *os.fsdecode(found).split()]


def targets(parser: ArgumentParser, **_: object) -> list[str]:
    """The targets of ``compile``, or those that ``run`` can run."""
    from cspdiag.codegen import TARGETS

    return ["python", "c", "auto"] if parser.prog == "cspdiag run" else list(TARGETS)


_OF_OPTIONS: dict[str, Completer] = {
    "--environment": environments,
    "--process": drawings,
    "--top": processes,
    "--set": settings,
    "--target": targets,
}
"""What completes the values of options that have the same meaning in every verb."""


def _settable(program: Program) -> Iterator[str]:
    from cspdiag.model.types import StructType
    from cspdiag.network.lower.setting_paths import paths_of
    from cspdiag.syntax import ast

    for item in program.definitions.values():
        if isinstance(item, ast.Constant):
            kind = program.types.get(item)
            if isinstance(kind, StructType):
                yield from (f"{item.name.text}.{field}" for field, _ in kind.fields)
            else:
                yield item.name.text
    for item in program.definitions.values():
        if isinstance(item, ast.EnvironmentDefinition):
            yield from (".".join(map(str, path)) for path in paths_of(program, item))


def _definitions(parsed_args: Namespace) -> list[object]:
    program = _program(parsed_args)
    return [] if program is None else list(program.definitions.values())


def _program(parsed_args: Namespace) -> Program | None:
    """The program that the line names, as far as it can be read; None if it cannot."""
    from cspdiag import pipeline
    from cspdiag.base.sources import read_source

    name = getattr(parsed_args, "file", None)
    if not isinstance(name, str) or name == "-":
        return None
    try:
        checked = pipeline.check(read_source(os.path.expanduser(name)), read_source)
    except OSError:
        return None
    return checked.program or checked.readable
