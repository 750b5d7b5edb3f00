"""What W0707 reports about the iterations of a loop is true of all paths through it, enumerated one by one.

``python -m tests.network.checks.samples.test_iterations NUMBER`` tries more loops.
"""

from __future__ import annotations

import random
import sys
from collections import Counter
from typing import TypeAlias

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.network.diagnostics.samples.rates import SamplesMissed

PROGRAM = """process Main {{
  in  x : int @ 10 ms
  in  e : int
  communication {{
    var v : int = 0
    var n : int = 0
  }}
  composition {{ mu ({turn}) }}
}}
"""

Ways: TypeAlias = set[tuple[int, int]]
"""The waiting time in milliseconds and the number of samples taken, for each path."""


def part(chance: random.Random, depth: int) -> tuple[str, Ways]:
    """A part of an iteration, and the paths through it."""
    kind = chance.randrange(3, 8) if depth else chance.randrange(4)
    match kind:
        case 0 | 3:
            delay = chance.choice((1, 2, 3, 5, 8, 12))
            return f"wait {delay} ms", {(delay, 0)}
        case 1:
            return "x ? v", {(0, 1)}
        case 2:
            return "skip", {(0, 0)}
        case 4:
            then, ways = part(chance, depth - 1)
            otherwise, others = part(chance, depth - 1)
            return f"(if n == {chance.randint(1, 9)} then {then} else {otherwise})", ways | others
        case 5:
            return f"(wait {chance.randint(8, 20)} ms interrupt after 7 ms -> n := n + 1)", {(7, 0)}
        case _:
            parts = [part(chance, depth - 1) for _ in range(chance.randint(2, 3))]
            ways = {(0, 0)}
            for _, others in parts:
                ways = _one_after_the_other(ways, others)
            return f"({' ; '.join(text for text, _ in parts)})", ways


def _one_after_the_other(ways: Ways, others: Ways) -> Ways:
    return {(waits + more, reads + others_read) for waits, reads in ways for more, others_read in others}


def is_true(found: SamplesMissed, ways: Ways) -> bool:
    """Whether the report is true of the paths through the loop."""
    reported = found.waits // 1_000_000, found.reads
    idle = {way for way in ways if not way[1]}
    match found.extent:
        case "every turn":
            return all(waits >= reported[0] and reads == reported[1] for waits, reads in ways)
        case "some turn":
            return reported in ways and any(waits < reported[0] or reads != reported[1] for waits, reads in ways)
        case "two turns":
            return reported in _one_after_the_other(ways - idle, idle)
        case _:
            return not found.turns


def hunt(seeds: range) -> tuple[Counter[str], list[int]]:
    """How often each kind of report occurred, and the seeds of the loops for which a report is not true."""
    counts: Counter[str] = Counter()
    wrong = []
    for seed in seeds:
        chance = random.Random(seed)
        turn, ways = part(chance, 3)
        if chance.random() < 0.7:
            turn, ways = f"x ? v ; {turn}", _one_after_the_other(ways, {(0, 1)})
        source = SourceFile(name="turns.csp", text=PROGRAM.format(turn=f"n := n + v ; {turn}"))
        checked = pipeline.build(source, read_source).checked
        for found in checked.report.diagnostics:
            if isinstance(found, SamplesMissed):
                counts[found.extent] += 1
                wrong += [] if is_true(found, ways) else [seed]
    return counts, wrong


def test_facts_about_iterations_hold_on_all_paths() -> None:
    counts, wrong = hunt(range(600))
    assert wrong == []
    assert min(counts[extent] for extent in ("every turn", "some turn", "two turns")) >= 3


if __name__ == "__main__":
    print(hunt(range(int(sys.argv[1]))))
