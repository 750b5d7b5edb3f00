"""``python -m tests.conformance TARGET [FOLDER]``: certifies a target and prints a table; the exit code is 1 if
anything differs.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from cspdiag.model.types import REALS
from tests.conformance.hunt import hunt
from tests.conformance.kit import Verdict, certify
from tests.conformance.sources import ROOT
from tests.conformance.targets import EMULATED, TARGETS, target_named

FOLDERS = (ROOT / "models", ROOT / "tests" / "conformance" / "programs")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command."""
    options = _parser().parse_args(arguments)
    name = options.target_option or options.target
    if name is None:
        _parser().error(f"which target? there are: {', '.join([*TARGETS, *EMULATED])}")
    try:
        target = target_named(name)
    except KeyError:
        _parser().error(f"no target {name!r}; there are: {', '.join([*TARGETS, *EMULATED])}")
    reason = target.unavailable()
    if reason is not None:
        print(f"{target.name}: {reason}")
        return 2
    if options.random:
        failure = hunt(target, options.random, options.seed, real=options.real)
        print(failure or f"{target.name}: {options.random} random programs are equal")
        return int(failure is not None)
    folders = [options.folder] if options.folder else FOLDERS
    limit = round(options.limit * 1e6)
    return show(verdict for folder in folders for verdict in certify(target, folder, limit, options.real))


def show(verdicts: Iterable[Verdict]) -> int:
    """Print a line for each program as it is compared, and what is wrong below it; returns 1 if anything is wrong."""
    failed = 0
    for verdict in verdicts:
        where = f" in {verdict.environment}" if verdict.environment else ""
        print(f"{verdict.result:8} {verdict.communications:8} {verdict.program}{where}", flush=True)
        if verdict.details:
            print("\n".join(f"    {line}" for line in verdict.details.splitlines()))
        failed += verdict.result not in ("equal", "refused")
    return int(failed > 0)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tests.conformance", description="Certifies a target.")
    parser.add_argument("target", nargs="?", help=", ".join([*TARGETS, *EMULATED]))
    parser.add_argument(
        "folder", nargs="?", type=Path, help="of programs; without it the models and the disputed cases"
    )
    parser.add_argument("--target", dest="target_option", metavar="TARGET", help="the same, as an option")
    parser.add_argument("--for", dest="limit", type=float, default=1200.0, metavar="MS", help="simulated milliseconds")
    parser.add_argument("--random", type=int, default=0, metavar="N", help="N random programs instead")
    parser.add_argument(
        "--seed", type=int, default=None, help="of the random programs; without it other ones each time"
    )
    parser.add_argument("--real", choices=REALS, default="double", help="what `double` means in the programs")
    return parser


if __name__ == "__main__":
    sys.exit(main())
