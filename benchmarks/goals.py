"""The goals of cspdiag's speed, each with what this machine reaches: ``python benchmarks/goals.py --page``.

Of each contestant the best sample counts, because whatever disturbs a machine can only slow a program down. Absolute
times are compared as if asyncio took as long for a communication as on the machine on which the goals were set, because
asyncio is measured in the same run; seconds of whole commands are processor time, compared likewise. ``--page`` writes
the table into ``docs/benchmarks.md``.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple, TypeAlias

sys.path += [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parent / "programs")]

from measuring import BENCHMARKS, measure
from scale import cost

PAGE = Path(__file__).parents[1] / "docs" / "benchmarks.md"
ASYNCIO = 3800.0
"""Nanoseconds for a communication of asyncio where the goals were set."""

Figures: TypeAlias = Mapping[tuple[str, str], float]
"""Best samples by benchmark and contestant, and costs by command and network."""

ONCE = ("real-time-late", "real-time-missed", "recording-npz")
"""What takes so long that it is measured in one round."""

COMMANDS = (
    ("check", "ring", "lines", 100_000),
    ("check", "ring", "array", 100_000),
    ("compile -O1", "ring", "lines", 100_000),
    ("compile -O1", "ring", "array", 100_000),
    ("C -O1", "ring", "lines", 100_000),
    ("C -O1", "ring", "array", 100_000),
    ("draw", "pipeline", "lines", 2_000),
)
"""Step, network, form and number of instances of the commands of which the processor time is measured."""


class Goal(NamedTuple):
    """``bound`` is what is to be reached: at most that, or at least if ``more``; ``needs`` are the figures that
    ``reached`` computes with, which is None where one of them is missing.
    """

    item: int
    what: str
    unit: str
    bound: float
    needs: tuple[tuple[str, str], ...]
    reached: Callable[..., float]
    more: bool = False


def _same(figure: float) -> float:
    return figure


def _ratio(one: float, other: float) -> float:
    return one / other


def _as_there(speed: float, asyncio: float) -> float:
    return speed * asyncio / ASYNCIO


def _time_there(time: float, asyncio: float) -> float:
    return time * ASYNCIO / asyncio


_ASYNCIO = ("commstime", "asyncio")
_OURS = ("commstime", "-O1")
GOALS = (
    Goal(1, "a communication at `-O1` against asyncio", "times", 38, (_ASYNCIO, _OURS), _ratio, more=True),
    Goal(1, "the same against PyCSP", "times", 18, (("commstime", "PyCSP"), _OURS), _ratio, more=True),
    Goal(1, "the same against asyncio, in small networks", "times", 45, (_ASYNCIO, _OURS), _ratio, more=True),
    Goal(2, "closed loop at `-O1`", "s a second", 450, (("closed-loop", "-O1"), _ASYNCIO), _as_there, more=True),
    Goal(2, "the same, fused", "s a second", 590, (("closed-loop", "-O1 fused"), _ASYNCIO), _as_there, more=True),
    Goal(2, "JIWY at `-O1`", "times real time", 190, (("jiwy", "-O1"), _ASYNCIO), _as_there, more=True),
    Goal(3, "JIWY recorded natively against not recorded", "times", 1.7, (("recording-npz", "C"),), _same),
    Goal(3, "the same in Python", "times", 1.15, (("recording-npz", "-O1"),), _same),
    Goal(4, "`check` of JIWY, cold", "ms", 100, (("check-cold", "cspdiag"), _ASYNCIO), _time_there),
    Goal(4, "`check --server` of JIWY", "ms", 40, (("check-server", "cspdiag"), _ASYNCIO), _time_there),
    Goal(5, "a waiting process with its channel at `-O1`", "bytes", 650, (("memory", "-O1"),), _same),
    Goal(6, "C: a choice among 10 writers against a communication", "times", 1.7,
         (("alternative-10", "C"), ("commstime", "C")), _ratio),
    Goal(6, "C: a choice among 1000 writers against one among 10", "times", 1.2,
         (("alternative-1000", "C"), ("alternative-10", "C")), _ratio),
    Goal(6, "C: a communication", "ns", 2, (("commstime", "C"), _ASYNCIO), _time_there),
    Goal(7, "`check` of 100,000 lines", "s", 7, (("check", "ring lines"), _ASYNCIO), _time_there),
    Goal(7, "its memory", "MB", 300, (("check memory", "ring lines"),), _same),
    Goal(7, "`check` of an array of 100,000", "s", 0.5, (("check", "ring array"), _ASYNCIO), _time_there),
    Goal(7, "`compile -O1` of 100,000 lines", "s", 18, (("compile -O1", "ring lines"), _ASYNCIO), _time_there),
    Goal(7, "`compile -O1` of an array of 100,000", "s", 2, (("compile -O1", "ring array"), _ASYNCIO), _time_there),
    Goal(7, "C at `-O1` of 100,000 lines", "s", 18, (("C -O1", "ring lines"), _ASYNCIO), _time_there),
    Goal(7, "C at `-O1` of an array of 100,000", "s", 2, (("C -O1", "ring array"), _ASYNCIO), _time_there),
    Goal(7, "`draw` of 2,000 instances", "s", 10, (("draw", "pipeline lines"), _ASYNCIO), _time_there),
    Goal(8, "Python at 1 kHz, loaded: 99 % of the ticks within", "us", 1000, (("real-time-late", "-O1"),), _same),
    Goal(8, "samples missed of 20,000", "", 653 / 3, (("real-time-missed", "-O1"),), _same),
)  # fmt: skip


def main(arguments: list[str]) -> int:
    """Measure, print the table, and write it into the page if asked to; returns 0."""
    parser = argparse.ArgumentParser(prog="python benchmarks/goals.py", description=__doc__)
    parser.add_argument("--rounds", type=int, default=5, metavar="N", help="how often each is measured (default: 5)")
    items = sorted({goal.item for goal in GOALS})
    parser.add_argument(
        "--item", type=int, action="append", choices=items, metavar="N", help="only the goals with this number"
    )
    parser.add_argument("--page", action="store_true", help=f"write the table into {PAGE.name}")
    given = parser.parse_args(arguments)
    if given.rounds < 1:
        parser.error("each has to be measured in at least one round")
    goals = [goal for goal in GOALS if not given.item or goal.item in given.item]
    load = os.getloadavg()[0]
    figures = measured({need for goal in goals for need in (*goal.needs, _ASYNCIO)}, given.rounds)
    lines = list(table(goals, figures, load))
    print("\n".join(lines))
    if given.page:
        text = PAGE.read_text(encoding="utf-8")
        before, _, rest = text.partition("<!-- figures -->\n")
        _, end, after = rest.partition("<!-- end of figures -->")
        assert end
        PAGE.write_text(f"{before}<!-- figures -->\n" + "\n".join(lines) + f"\n{end}{after}", encoding="utf-8")
    return 0


def measured(needs: set[tuple[str, str]], rounds: int) -> dict[tuple[str, str], float]:
    """The figures that are needed, as far as this machine has what they need."""
    figures: dict[tuple[str, str], float] = {}
    for benchmark in BENCHMARKS:
        chosen = {name: program for name, program in benchmark.contestants.items() if (benchmark.name, name) in needs}
        if chosen:
            print(f"{benchmark.name} ...", file=sys.stderr, flush=True)
            samples = measure(replace(benchmark, contestants=chosen), 1 if benchmark.name in ONCE else rounds)
            best = min if benchmark.less else max
            figures |= {(benchmark.name, name): best(values) for name, values in samples.items() if values}
    for step, network, form, count in COMMANDS:
        if (step, f"{network} {form}") in needs:
            print(f"{step} {network} {form} ...", file=sys.stderr, flush=True)
            row = cost(step, network, form, count, limit=180)
            if not row.end:
                figures[step, f"{network} {form}"] = row.seconds
                figures[f"{step} memory", f"{network} {form}"] = row.memory / 1e6
    return figures


def table(goals: list[Goal], figures: Figures, load: float) -> Iterator[str]:
    """A table in Markdown, after a sentence about the machine."""
    speed = figures.get(_ASYNCIO)
    if speed is not None:
        yield f"Measured with a load of {load:.1f}, where asyncio takes {speed:,.0f} ns for a communication; times and"
        yield f"speeds are scaled to {ASYNCIO:,.0f} ns. Seconds are processor time."
        yield ""
    yield "| item | goal | | reached | |"
    yield "| ---: | --- | ---: | ---: | --- |"
    for goal in goals:
        asked = f"{'at least' if goal.more else 'at most'} {goal.bound:,.4g} {goal.unit}".rstrip()
        values = [figures.get(need) for need in goal.needs]
        if any(value is None for value in values):
            yield f"| {goal.item} | {goal.what} | {asked} | | not measured |"
            continue
        reached = goal.reached(*values)
        yield f"| {goal.item} | {goal.what} | {asked} | {reached:,.3g} {goal.unit} | {judged(goal, reached)} |"


def judged(goal: Goal, reached: float) -> str:
    """Whether a goal is met, or by how much it is missed."""
    if reached >= goal.bound if goal.more else reached <= goal.bound:
        return "met"
    apart = goal.bound / reached if goal.more else reached / goal.bound
    return f"missed by {apart - 1:.0%}" if apart < 2 else f"missed {apart:.1f} times"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
