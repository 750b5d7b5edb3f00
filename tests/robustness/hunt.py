"""Thousands of damaged programs: ``python -m tests.robustness.hunt --count 100000 --start 0`` (about 40 ms each).

Each program that gets a traceback, a diagnostic outside its text, or no answer is kept in ``build/damaged/SEED.csp``
with what happened.
"""

from __future__ import annotations

import sys
import traceback
from argparse import ArgumentParser
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from os import cpu_count
from pathlib import Path

from tests.robustness.answers import answer
from tests.robustness.damage import damaged

KEPT = Path("build/damaged")
BLOCK = 200
"""How many programs a process tries before it reports."""


def outcome_of(seed: int) -> str:
    """The answer for a damaged program: ``code``, ``errors``, or the traceback of what should not have happened."""
    path, text = damaged(seed)
    try:
        checked = answer(str(path), text)
    except Exception:
        return traceback.format_exc()
    return "errors" if checked.report.has_errors or checked.program is None else "code"


def _block(seeds: range) -> list[tuple[int, str]]:
    return [(seed, outcome_of(seed)) for seed in seeds]


def hunt(count: int, start: int, processes: int) -> Counter[str]:
    """Try programs of ``count`` seeds from ``start`` on; keep those without an answer."""
    blocks = [range(first, min(first + BLOCK, start + count)) for first in range(start, start + count, BLOCK)]
    tally: Counter[str] = Counter()
    with ProcessPoolExecutor(processes) as pool:
        for done in pool.map(_block, blocks):
            for seed, found in done:
                tally["no answer" if "\n" in found else found] += 1
                if "\n" in found:
                    KEPT.mkdir(parents=True, exist_ok=True)
                    (KEPT / f"{seed}.csp").write_text(damaged(seed)[1], encoding="utf-8")
                    print(f"{KEPT / f'{seed}.csp'}, from {damaged(seed)[0].name}:\n{found}", flush=True)
    return tally


def main() -> int:
    """Hunt as the command line says; returns 1 if a program got no answer."""
    parser = ArgumentParser(description="Damaged programs, and what they get.")
    parser.add_argument("--count", type=int, default=2_000, help="programs (default: 2000)")
    parser.add_argument("--start", type=int, default=0, help="first seed (default: 0)")
    parser.add_argument("--processes", type=int, default=cpu_count() or 1, help="default: one a core")
    given = parser.parse_args()
    tally = hunt(given.count, given.start, given.processes)
    print(", ".join(f"{number} {kind}" for kind, number in sorted(tally.items())))
    return 1 if tally["no answer"] else 0


if __name__ == "__main__":
    sys.exit(main())
