"""What is observed in a run of a program whose samples carry their instants: the ages of its outputs, and how long
changes take.
"""

from __future__ import annotations

from typing import NamedTuple

from cspdiag.simulate.result import Run


class Seen(NamedTuple):
    """The largest age of a sample behind an output, the longest time from a change right after a sample to an output
    that is based on a later sample, and the smallest age; in nanoseconds.
    """

    age: int
    reaction: int
    youngest: int


def seen_in(found: Run, output: str) -> Seen:
    """What is observed at an output of the program that carries the instant of a sample in seconds; zero is no
    sample.
    """
    reaction = last = 0
    ages: list[int] = []
    for passed in found.communications:
        sample = round(passed.value * 1e9) if passed.channel == output else 0  # type: ignore[operator,arg-type]
        if sample:
            ages.append(passed.time - sample)
            if sample > last:
                reaction = max(reaction, passed.time - last if last else 0)
                last = sample
    return Seen(max(ages, default=0), reaction, min(ages, default=0))
