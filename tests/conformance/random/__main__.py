"""``python -m tests.conformance.random --count 5000``: random programs with at least five communications on every
target.

Each is run as readable and as optimized Python, and in C at ``-O0`` and ``-O1`` with each compiler; one in twenty with
the address and undefined behaviour sanitizers too. A program that differs is made smaller, printed and written to a
folder; the exit code is then 1. Uses one process; with ``--seconds`` it stops by itself, and reports the seed from
which to continue.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from tests.conformance.random.compare import LEAST, NATIVE, communications, difference, smallest
from tests.conformance.random.known import known
from tests.conformance.random.meetings import meetings
from tests.conformance.random.nested import nested
from tests.conformance.random.parametrized import parametrized
from tests.conformance.random.parts import parts
from tests.conformance.random.tuned import tuned
from tests.conformance.random.turns import turns

PYTHON = ("python-O0", "python-O1")
REPORTED = 100
"""The number of differences is reported every time after this number of programs."""
GENERATORS = {
    "meetings": meetings,
    "known": known,
    "nested": nested,
    "parts": parts,
    "tuned": tuned,
    "parametrized": parametrized,
    "turns": turns,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command."""
    options = _parser().parse_args(arguments)
    until = time.monotonic() + options.seconds if options.seconds else None
    seed, tried, found = options.first, 0, 0
    while tried < options.count and (until is None or time.monotonic() < until):
        program, seed = GENERATORS[options.programs](seed), seed + 1
        made = communications(str(program))
        if made is None or made < LEAST:
            continue
        tried += 1
        runs: list[tuple[tuple[str, ...], str | None, bool]] = [(PYTHON, None, False)]
        compilers = options.compilers
        if compilers and options.in_turn:
            compilers = [compilers[tried % len(compilers)]]
        runs += [(NATIVE, compiler, False) for compiler in compilers]
        if options.compilers and options.sanitize and tried % options.sanitize == 0:
            runs.append((NATIVE, options.compilers[0], True))
        for names, compiler, sanitized in runs:
            reported = difference(str(program), names, compiler, sanitized=sanitized)
            if reported:
                found += 1
                least, reported = smallest(program, reported, names, compiler, options.shrink, sanitized=sanitized)
                options.folder.mkdir(parents=True, exist_ok=True)
                place = options.folder / f"seed_{seed - 1}.csp"
                place.write_text(str(least), encoding="utf-8")
                print(f"seed {seed - 1}: {reported}\n  {place}", flush=True)
                break
        if tried % REPORTED == 0:
            print(f"{tried} programs, to seed {seed - 1}: {found} differ", flush=True)
    print(f"{tried} programs with at least {LEAST} communications, to seed {seed - 1}: {found} differ")
    return int(found > 0)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tests.conformance.random", description=__doc__)
    parser.add_argument("--count", type=int, default=5000, help="the number of programs")
    parser.add_argument(
        "--programs",
        choices=sorted(GENERATORS),
        default="meetings",
        help="that communicate often, compute with what is known beforehand, nest interrupts whose guards meet, "
        "deadlock between parallel parts of a process, communicate with one element of an array after the other or "
        "with whichever is ready, or whose parameters change: in laws and arrays of laws, or in the place of literals "
        "of the others",
    )
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("--seconds", type=float, default=None, help="stop after this many seconds")
    parser.add_argument("--shrink", type=float, default=60.0, help="seconds to make a program smaller that differs")
    parser.add_argument(
        "--sanitize", type=int, default=20, metavar="N", help="one in N under the sanitizers, 0 for none"
    )
    parser.add_argument("--compilers", nargs="*", default=["gcc", "clang"], help="none: no C at all")
    parser.add_argument("--in-turn", action="store_true", help="each program under one of the compilers, in turn")
    parser.add_argument("--folder", type=Path, default=Path("differences"), help="for programs that differ")
    return parser


if __name__ == "__main__":
    sys.exit(main())
