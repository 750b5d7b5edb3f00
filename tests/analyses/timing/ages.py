"""Compares the ages, reactions and shortest latencies that are reported for a random chain with runs of it."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass

from cspdiag.analyses.timing.report.timing import timing_report
from tests.analyses.timing.processor import on_processor, run, wcets, with_bench
from tests.analyses.timing.programs import MS, US
from tests.analyses.timing.random.aged import QUARTER, Aged
from tests.analyses.timing.seen import seen_in

UNTIL = 130 * MS
"""A little more than twice the common multiple of the periods."""


@dataclass
class Compared:
    """The result for one program: whether it was proved, what is wrong in a run, whether a run reaches the bounds, and
    which bounds there are.
    """

    is_proved: bool
    wrong: str = ""
    is_age_reached: bool = False
    is_reaction_reached: bool = False
    is_age_bounded: bool = False
    is_reaction_bounded: bool = False


def compared(seed: int) -> Compared:
    """Compare the bounds of the program of a seed with runs in which laws take their longest times, no time, and other
    times.
    """
    program = Aged(seed)
    network = with_bench(program.text, program.inputs, ["y"], "1 ms")
    report = timing_report(network)
    if not report.is_schedulable:
        return Compared(is_proved=False)
    between = [chain for chain in report.chains if (chain.source, chain.sink) == ("x0", "y")]
    if not between:
        return Compared(is_proved=True, wrong="no chain from `x0` to `y`")
    ages, reactions = [chain.age for chain in between], [chain.reaction for chain in between]
    age = max((each for each in ages if each is not None), default=0) if None not in ages else None
    reaction = max((each for each in reactions if each is not None), default=0) if None not in reactions else None
    # More time passes from a sample that went through other loops before.
    shortest = min((loop.latency[0] for loop in report.loops if loop.latency is not None), default=0)
    found = Compared(is_proved=True, is_age_bounded=age is not None, is_reaction_bounded=reaction is not None)
    with on_processor():
        for k, times in enumerate(_execution_times(wcets(network), random.Random(seed))):
            seen = seen_in(run(network, times, UNTIL), "Main.y")
            found.is_age_reached |= seen.age == age
            found.is_reaction_reached |= seen.reaction == reaction
            problems = [f"age {seen.age} of {age}"] * (age is not None and seen.age > age)
            problems += [f"reaction {seen.reaction} of {reaction}"] * (
                reaction is not None and seen.reaction > reaction
            )
            problems += [f"latency {seen.youngest} from {shortest}"] * (seen.age > 0 and seen.youngest < shortest)
            if problems:
                found.wrong = f"run {k}: {', '.join(problems)}"
    return found


def _execution_times(stated: dict[str, int], source: random.Random) -> list[Callable[[str], int]]:
    quarter = QUARTER * US
    return [
        stated.__getitem__,
        lambda _: 0,
        lambda path: quarter * source.randint(0, stated[path] // quarter),
        lambda path: source.randint(0, stated[path]),
    ]
