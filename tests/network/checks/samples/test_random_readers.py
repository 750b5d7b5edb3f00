"""W0707 for random loops, compared with all runs of them: if it warns, a run misses a sample, and if a run without
events misses one, it has warned.

``python -m tests.network.checks.samples.test_random_readers NUMBER [FIRST]`` tries more programs.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterable

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.network.diagnostics.samples.rates import SamplesMissed
from tests.network.checks.samples.random_readers import reader
from tests.oracle.explore import explore
from tests.oracle.programs.text import text
from tests.oracle.programs.tree import After, Alt, Bin, Interrupt, Program, Skip, walk
from tests.support.thorough import usual_or_thorough


def warned(source: str) -> list[SamplesMissed] | None:
    """The warnings about missed samples; None if the program is refused."""
    built = pipeline.build(SourceFile(name="reader.csp", text=source), read_source)
    if built.network is None:
        return None
    found = [item for item in built.checked.report.diagnostics if isinstance(item, SamplesMissed)]
    # If an iteration takes exactly as long as its samples, something else has to take time.
    return [item for item in found if not (item.turns and item.waits == item.reads * item.period)] or found[:0]


def depends_on_values(program: Program) -> bool:
    """Whether a value decides which path is taken, perhaps twice."""
    tests = [getattr(part, name, None) for part in walk(program.body) for name in ("condition", "until", "when")]
    return any(isinstance(test, Bin) for test in tests)


def depends_on_phases(program: Program) -> bool:
    """Whether the age of a sample matters: to a time-out, or to a branch that is ready at once."""
    for part in walk(program.body):
        events = [part.guard.event] if isinstance(part, Interrupt) else []
        events += [branch.event for branch in part.branches] if isinstance(part, Alt) else []
        if any(isinstance(event, After | Skip) for event in events):
            return True
    return False


def compare(seed: int) -> str:
    """The result for a program: ``alarm`` and ``silence`` are wrong."""
    program = reader(seed)
    source = text(program)
    found = warned(source)
    if found is None:
        return "refused"
    graph = explore(program, free=False, limit=6000, seconds=5)
    if not any(state.timeout for state in graph.states):
        if not graph.complete:
            return "open"
        return "in time" if not found else "alarm by values" if depends_on_values(program) else "alarm"
    if found:
        return "missed"
    if depends_on_values(program):
        return "silence by values"
    if depends_on_phases(program):
        return "silence by phases"
    return "silence by events" if any(port.period is None for port in program.ports) else "silence"


def hunt(seeds: Iterable[int]) -> tuple[Counter[str], list[tuple[int, str]]]:
    """How many programs had each result, and those with a wrong result."""
    counts: Counter[str] = Counter()
    wrong: list[tuple[int, str]] = []
    for seed in seeds:
        found = compare(seed)
        counts[found] += 1
        if found in ("alarm", "silence"):
            wrong.append((seed, found))
    return counts, wrong


def test_warnings_are_of_runs_that_miss_samples() -> None:
    counts, wrong = hunt(range(usual_or_thorough(30, 300)))
    assert wrong == []
    assert counts["missed"] > usual_or_thorough(7, 70)
    assert counts["in time"] > usual_or_thorough(7, 70)


if __name__ == "__main__":
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    all_counts, all_wrong = hunt(range(first, first + int(sys.argv[1])))
    print(dict(all_counts), all_wrong)
    sys.exit(bool(all_wrong))
