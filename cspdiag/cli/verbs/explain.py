"""``cspdiag explain``: the manual page of a diagnostic."""

from __future__ import annotations

import re
from argparse import ArgumentParser, Namespace

from cspdiag.base.manual import manual_pages, reference
from cspdiag.cli.support.failure import FINE, UsageError
from cspdiag.cli.support.terminal import write_out

EXAMPLE = "cspdiag explain E0301\ncspdiag explain"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "code", nargs="?", metavar="CODE", help="a code such as E0301, or its number; without one, all are listed"
    )
    parser.add_argument("--markdown", action="store_true", help="print the whole reference as Markdown")


def run(arguments: Namespace) -> int:
    """Print the page, the list or the reference."""
    if arguments.markdown:
        if arguments.code is not None:
            raise UsageError("--markdown prints the whole reference and takes no CODE")
        write_out(reference())
    elif arguments.code is None:
        write_out("".join(f"{page.code}  {page.title}\n" for page in manual_pages().values()))
    else:
        write_out(_page(arguments.code))
    return FINE


def _page(code: str) -> str:
    pages = manual_pages()
    # Numbers are unique, so the letter and leading zeros add nothing.
    number = re.fullmatch(r"[EW]?0*([0-9]{1,4})", code.strip().upper())
    if number is not None:
        for known, page in pages.items():
            if known[1:].lstrip("0") == number[1]:
                return page.text
    near = [known for known in pages if _differences(known, code.upper()) == 1]
    help_ = f"did you mean {near[0]}?" if near else "cspdiag explain lists them all"
    raise UsageError(f"there is no diagnostic {code!r} ({help_})")


def _differences(left: str, right: str) -> int:
    return abs(len(left) - len(right)) + sum(a != b for a, b in zip(left, right, strict=False))
