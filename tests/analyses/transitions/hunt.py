"""Looks for random programs that do what their transition system does not allow: ``python -m tests.analyses.transitions.hunt --random 1000``."""

from __future__ import annotations

import sys
from argparse import ArgumentParser
from collections import Counter
from collections.abc import Sequence
from random import SystemRandom

from cspdiag.diagnostics import SourceFile
from tests.analyses.transitions.following import Lost
from tests.analyses.transitions.test_following import assert_allowed, run_of
from tests.conformance.sources import network_of
from tests.properties.drawing import draw_programs

A_START = 10
"""How many programs are drawn from one start."""


class NotAllowedError(Exception):
    """A program, and what its system does not allow."""


def hunt(count: int, start: int, limit: int, *, shrink: bool) -> Counter[str]:
    """How the runs of so many programs ended, and how many could not be followed within ``limit`` states. Raises NotAllowedError."""
    found: Counter[str] = Counter()

    def look(text: str) -> None:
        network = network_of(SourceFile(name="random.csp", text=text))
        run = run_of(network)
        try:
            allowed = assert_allowed(network, run, limit)
        except Lost as lost:
            raise NotAllowedError(f"{text}\n{lost}") from None
        found[run.outcome.ended if allowed else "too many states"] += 1

    for number in range(0, count, A_START):
        draw_programs(look, min(A_START, count - number), start + number // A_START, shrink=shrink)
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """0 if every run was allowed; the smallest program otherwise."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--random", type=int, default=200, metavar="N", help="how many programs (default: 200)")
    parser.add_argument("--start", type=int, help="for the same programs as another time")
    parser.add_argument("--limit", type=int, default=20_000, help="states to follow a run through (default: 20000)")
    parser.add_argument("--as-found", action="store_true", help="do not make the program smaller")
    given = parser.parse_args(arguments)
    start = SystemRandom().randrange(2**32) if given.start is None else given.start
    try:
        found = hunt(given.random, start, given.limit, shrink=not given.as_found)
    except NotAllowedError as program:
        sys.stdout.write(f"start {start}:\n{program}\n")
        return 1
    sys.stdout.write("".join(f"{ended}: {number}\n" for ended, number in found.most_common()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
