"""``cspdiag bench``: run the benchmarks on this machine."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace

from cspdiag.base.files.resources import benchmark_folder
from cspdiag.cli.support.failure import FINE
from cspdiag.cli.support.files.written import require_file

EXAMPLE = "cspdiag bench --only commstime --rounds 5"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--only", action="append", default=[], metavar="NAME", help="only this one; may be given again")
    parser.add_argument("--rounds", metavar="N", help="how often each is run")
    parser.add_argument("--json", metavar="FILE", help="also write all samples and medians")


def run(arguments: Namespace) -> int:
    """Run the program that the folder of the benchmarks is; it ends the process by itself where it
    refuses something.
    """
    from runpy import run_path

    require_file("--json", arguments.json)
    folder = str(benchmark_folder())
    sys.argv = [folder]
    for name in arguments.only:
        sys.argv += ["--only", name]
    for option in ("rounds", "json"):
        value = getattr(arguments, option)
        if value is not None:
            sys.argv += [f"--{option}", value]
    run_path(folder, run_name="__main__")
    return FINE
