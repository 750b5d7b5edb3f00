"""``cspdiag lsp``: serve an editor."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace

from cspdiag.cli.support.failure import FINE, needed_packages
from cspdiag.cli.support.terminal import say

EXAMPLE = "cspdiag lsp        # started by an editor, which talks to it on standard input and output"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--stdio", action="store_true", help="accepted because some editors add it; it is the default")


def run(arguments: Namespace) -> int:
    """Serve until the editor ends the connection."""
    with needed_packages("lsp", "pygls", "lsprotocol"):
        from cspdiag.lsp.requests import serve
    if sys.stdin.isatty():
        say("this waits for messages of an editor; docs/editors.md has the settings of editors, Ctrl-C ends it")
    serve()
    return FINE
