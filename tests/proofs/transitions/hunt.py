"""Searches for random programs that do what their transition system does not allow: ``python -m
tests.proofs.transitions.hunt --random 1000``.

With ``--schedules 20`` each program is also run 20 times by the reference, in any order and with any input from
outside; a program that is proved free from deadlock reaches none in any of these runs.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser
from collections import Counter
from collections.abc import Sequence
from random import SystemRandom

from cspdiag.base import SourceFile
from cspdiag.network.ir.network import Network
from cspdiag.proofs.portfolio import prove_deadlock_free
from cspdiag.proofs.transitions import transition_system
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import Limits, Proved
from tests.conformance.sources import network_of
from tests.proofs.transitions.following import Lost
from tests.proofs.transitions.schedules import random_run
from tests.proofs.transitions.test_following import assert_allowed, is_followed, run_of
from tests.properties.drawing import draw_programs

LONGEST_RUN = 40_000_000
"""How long a program runs in any order, in nanoseconds."""
A_START = 10
"""How many programs are drawn from one start."""


class NotAllowedError(Exception):
    """A program, and what its system does not allow."""


def hunt(count: int, start: int, limit: int, schedules: int = 0, *, shrink: bool) -> Counter[str]:
    """How the runs of ``count`` programs ended, and how many could not be followed within ``limit`` states. Raises
    NotAllowedError.
    """
    found: Counter[str] = Counter()

    def look(text: str) -> None:
        network = network_of(SourceFile(name="random.csp", text=text))
        run = run_of(network)
        try:
            allowed = assert_allowed(network, run, limit)
            found[run.outcome.ended if allowed else "too many states"] += 1
            if schedules:
                found.update(schedule(network, schedules, limit))
        except Lost as lost:
            raise NotAllowedError(f"{text}\n{lost}") from None

    for number in range(0, count, A_START):
        draw_programs(look, min(A_START, count - number), start + number // A_START, shrink=shrink)
    return found


def schedule(network: Network, count: int, limit: int, system: System | None = None) -> Counter[str]:
    """How a number of runs in any order ended. Raises Lost, with the seed of the run, if the system (that of the
    network unless another one is given) does not allow it.
    """
    system = system or transition_system(network)
    proved = isinstance(prove_deadlock_free(system, Limits(5.0)), Proved)
    found: Counter[str] = Counter({"any order: proved free from deadlock": proved})
    for seed in range(count):
        run = random_run(network, seed, until=LONGEST_RUN)
        made = [(entry.channel, entry.value) for entry in run.trace]
        try:
            allowed = is_followed(system, network, made, run.ending.ended, limit)
        except Lost as lost:
            raise Lost(f"schedule {seed}: {lost}") from None
        if proved and run.ending.ended == "deadlock":
            raise Lost(f"schedule {seed}: proved free from deadlock, but deadlocks at {run.ending.time}")
        found[f"any order: {run.ending.ended if allowed else 'too many states'}"] += 1
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """0 if every run was allowed; otherwise the smallest program."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--random", type=int, default=200, metavar="N", help="how many programs (default: 200)")
    parser.add_argument("--start", type=int, help="for the same programs as another time")
    parser.add_argument("--limit", type=int, default=20_000, help="states to follow a run through (default: 20000)")
    parser.add_argument(
        "--schedules", type=int, default=0, metavar="N", help="runs of each program in any order (default: none)"
    )
    parser.add_argument("--as-found", action="store_true", help="do not make the program smaller")
    given = parser.parse_args(arguments)
    start = SystemRandom().randrange(2**32) if given.start is None else given.start
    try:
        found = hunt(given.random, start, given.limit, given.schedules, shrink=not given.as_found)
    except NotAllowedError as program:
        sys.stdout.write(f"start {start}:\n{program}\n")
        return 1
    sys.stdout.write("".join(f"{ended}: {number}\n" for ended, number in found.most_common()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
