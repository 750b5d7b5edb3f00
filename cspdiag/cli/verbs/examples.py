"""``cspdiag examples``: the example programs, and copies of them."""

from __future__ import annotations

import os
import shlex
from argparse import ArgumentParser, Namespace

from cspdiag.base.files.examples import main_program, summaries
from cspdiag.base.render.snippet import on_one_line
from cspdiag.cli.support.failure import FINE
from cspdiag.cli.support.files.examples import files_of
from cspdiag.cli.support.files.output import write_new_folders
from cspdiag.cli.support.files.written import given_name
from cspdiag.cli.support.terminal import say, write_out

EXAMPLE = "cspdiag examples\ncspdiag examples jiwy && cspdiag run jiwy/jiwy.csp"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("example", nargs="?", metavar="EXAMPLE", help="copy this one; without it, all are listed")
    parser.add_argument(
        "-o", "--output", type=given_name, metavar="DIR", default=".", help="where its folder goes (default: here)"
    )


def run(arguments: Namespace) -> int:
    """Print the list, or copy one example."""
    if arguments.example is None:
        found = summaries()
        width = max(map(len, found))
        write_out("".join(f"{name:<{width}}  {summary}\n" for name, summary in found.items()))
        return FINE
    files = files_of(arguments.example)
    write_new_folders(arguments.output, files)
    folders = list(dict.fromkeys(os.path.join(arguments.output, path.partition("/")[0]) for path in files))
    program = os.path.join(folders[0], main_program(arguments.example))
    say(f"wrote {on_one_line(' and '.join(map(os.path.normpath, folders)))}; README.md explains it")
    say(f"try: cspdiag run {on_one_line(shlex.quote(os.path.normpath(program)))}")
    return FINE
