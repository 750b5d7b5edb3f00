"""``cspdiag bench``: run the benchmarks on this machine."""

from __future__ import annotations

import sys
from argparse import REMAINDER, ArgumentParser, Namespace

from cspdiag.cli.failure import FINE
from cspdiag.resources import benchmark_folder

EXAMPLE = "cspdiag bench"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("arguments", nargs=REMAINDER, metavar="...", help="handed on to the benchmarks")


def run(arguments: Namespace) -> int:
    """Run the program that the folder of the benchmarks is."""
    from runpy import run_path

    folder = str(benchmark_folder())
    sys.argv = [folder, *arguments.arguments]
    run_path(folder, run_name="__main__")
    return FINE
