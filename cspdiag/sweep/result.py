"""What a run of a sweep had as its result."""

from __future__ import annotations

from typing import Final, Literal, TypeAlias

from cspdiag.base.record import record

Ended: TypeAlias = Literal["terminated", "failed", "deadlock", "time limit", "refused", "crashed"]
"""How a run ended, as for ``cspdiag run``; ``refused``: the program cannot have the values; ``crashed``: the process
that made the run died, twice.
"""

ENDINGS: Final[tuple[Ended, ...]] = ("terminated", "failed", "deadlock", "time limit", "refused", "crashed")

FAILED: Final[frozenset[Ended]] = frozenset({"failed", "refused", "crashed"})
"""The ends of runs that have not done what they were made for."""


@record
class Result:
    """How a run ended, at which time in seconds, the reason of a failure in one line, and what was measured: None if
    there was nothing to measure.
    """

    ended: Ended
    time: float
    error: str
    measured: tuple[float | None, ...]


def without_measures(ended: Ended, error: str, count: int) -> Result:
    """The result of a run that did not begin, or that nothing is known of."""
    return Result(ended, 0.0, error, (None,) * count)
