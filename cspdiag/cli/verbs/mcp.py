"""``cspdiag mcp``: serve an assistant."""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace

from cspdiag.cli.support.failure import FINE, UsageError, needed_packages
from cspdiag.cli.support.files.written import given_name

EXAMPLE = """cspdiag mcp models       # started by an assistant, which talks to it on standard input and output"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "folder",
        type=given_name,
        metavar="FOLDER",
        nargs="?",
        default=os.curdir,
        help="the folder with the programs; others cannot be named (default: the current one)",
    )


def run(arguments: Namespace) -> int:
    """Serve until the assistant ends the connection."""
    from pathlib import Path

    folder = Path(arguments.folder)
    if not folder.is_dir():
        raise UsageError(f"{folder}: there is no such folder")
    with needed_packages("mcp", "mcp", "pydantic"):
        from cspdiag.assistants.serving import serve
    serve(folder)
    return FINE
