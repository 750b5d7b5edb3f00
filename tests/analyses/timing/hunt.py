"""Compares what is proved of random programs with runs of them: ``python -m tests.analyses.timing.hunt --random 5000``
tries 5000 programs.

Each program that is proved schedulable is run four times on a processor that takes time (no time, the longest times,
and times in between), with inputs that change randomly. It is wrong if a sample is missed, or if the run or its time
stands still. Prints what is wrong, how many programs were proved, and why others were not.

As many random chains whose samples carry their instants are run in the same way, with hops that end exactly at each
other's ticks: an output that is older than its age, a change that is seen later than the reaction, and an output
younger than the shortest latency are wrong.
"""

from __future__ import annotations

import argparse
import re
from collections import Counter
from dataclasses import dataclass, field

from cspdiag.analyses.timing.report.timing import timing_report
from tests.analyses.timing.ages import compared
from tests.analyses.timing.judge import build, missed
from tests.analyses.timing.random.meetings import Meetings
from tests.analyses.timing.random.shapes import Shapes


@dataclass
class Found:
    """The results for some programs: how many got each answer, those that are wrong, and the reasons why others were
    not proved.
    """

    answers: Counter[str] = field(default_factory=Counter)
    wrong: list[tuple[int, str]] = field(default_factory=list)
    reasons: Counter[str] = field(default_factory=Counter)


def hunt(first: int, count: int) -> Found:
    """Try the valid programs with sampled loops of ``count`` seeds, from a first one on; in every third, some loops
    meet.
    """
    found = Found()
    for seed in range(first, first + count):
        network = build((Meetings if seed % 3 == 2 else Shapes)(seed).text)
        if network is None:
            continue
        report = timing_report(network)
        if not report.loops:
            continue
        answer = {True: "proved", False: "refuted", None: "unknown"}[report.is_schedulable]
        found.answers[answer] += 1
        if answer != "proved":
            found.reasons[re.sub(r"`[^`]*`", "`…`", report.reason)] += 1
            continue
        reported = missed(network, seed)
        if reported:
            found.wrong.append((seed, reported))
    return found


def hunt_ages(first: int, count: int) -> Found:
    """Try the chains of ``count`` seeds, from a first one on; also count the bounds that runs reach."""
    found = Found()
    for seed in range(first, first + count):
        one = compared(seed)
        found.answers["proved" if one.is_proved else "not proved"] += 1
        found.answers["age reached"] += one.is_age_reached
        found.answers["reaction reached"] += one.is_reaction_reached
        found.answers["age bounded"] += one.is_age_bounded
        found.answers["reaction bounded"] += one.is_reaction_bounded
        if one.wrong:
            found.wrong.append((seed, one.wrong))
    return found


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--random", type=int, default=500, help="how many programs")
    parser.add_argument("--first", type=int, default=0, help="the seed of the first of them")
    arguments = parser.parse_args()
    found = hunt(arguments.first, arguments.random)
    print(dict(found.answers))
    for reason, count in found.reasons.most_common(12):
        print(f"  {count} {reason}")
    ages = hunt_ages(arguments.first, arguments.random)
    print("chains:", dict(ages.answers))
    for seed, reported in [*found.wrong, *ages.wrong]:
        print(f"WRONG {seed}: {reported}")
    return 1 if found.wrong or ages.wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
