"""``cspdiag explain``: the manual page of a diagnostic."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace

from cspdiag.catalogue import manual_pages, reference
from cspdiag.cli.failure import FINE, UsageError

EXAMPLE = "cspdiag explain E0301\ncspdiag explain"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("code", nargs="?", metavar="CODE", help="a code such as E0301; without one, all are listed")
    parser.add_argument("--markdown", action="store_true", help="print the whole reference as Markdown")


def run(arguments: Namespace) -> int:
    """Print the page, the list or the reference."""
    if arguments.markdown:
        if arguments.code is not None:
            raise UsageError("--markdown prints the whole reference and takes no CODE")
        sys.stdout.write(reference())
    elif arguments.code is None:
        for page in manual_pages().values():
            print(f"{page.code}  {page.title}")
    else:
        sys.stdout.write(_page(arguments.code))
    return FINE


def _page(code: str) -> str:
    pages = manual_pages()
    page = pages.get(code.upper())
    if page is not None:
        return page.text
    near = [known for known in pages if _differences(known, code.upper()) == 1]
    help_ = f"did you mean {near[0]}?" if near else "cspdiag explain lists them all"
    raise UsageError(f"there is no diagnostic {code!r} ({help_})")


def _differences(left: str, right: str) -> int:
    return abs(len(left) - len(right)) + sum(a != b for a, b in zip(left, right, strict=False))
