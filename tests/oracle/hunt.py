"""Hunts for wrong answers: random programs, cspdiag as a black box, and the answer of the explorer.

    python -m tests.oracle.hunt --property deadlock --count 1000 --seed 0

An answer is wrong if it is PROVED and a run of the program fails, or REFUTED although all runs were explored and none
fails.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count, islice

from tests.oracle.compare import COMPARISONS, Case, Outcome
from tests.oracle.programs.nested import is_nested


@dataclass
class Report:
    counts: Counter[str]
    wrong: list[tuple[int, Outcome]]

    def __str__(self) -> str:
        return "  ".join(f"{name} {number}" for name, number in sorted(self.counts.items()))


def hunt(name: str, seeds: Iterator[int] | range, *, loud: bool = False, until: float = float("inf")) -> Report:
    """Compare on programs generated from seeds."""
    report = Report(Counter(), [])
    comparison = COMPARISONS[name]
    for seed in seeds:
        if time.monotonic() > until:
            break
        outcome = comparison.compare(Case(seed))
        report.counts["programs"] += 1
        report.counts.update(outcome.counted)
        if outcome.wrong:
            report.counts["wrong"] += 1
            report.wrong.append((seed, outcome))
            if loud:
                print(f"---- seed {seed}: {outcome.wrong}\n{outcome.text}", flush=True)
        if loud and report.counts["programs"] % 100 == 0:
            print(report, file=sys.stderr, flush=True)
    return report


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.oracle.hunt", description=__doc__)
    parser.add_argument("--property", choices=sorted(COMPARISONS), required=True)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=60)
    parser.add_argument("--nested", action="store_true", help="only programs with nested interrupts that meet")
    arguments = parser.parse_args()
    selected = filter(is_nested, count(arguments.seed)) if arguments.nested else count(arguments.seed)
    seeds = islice(selected, arguments.count)
    report = hunt(arguments.property, seeds, loud=True, until=time.monotonic() + 60 * arguments.minutes)
    print(report)
    return 1 if report.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
