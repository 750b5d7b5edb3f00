"""How a program followed a trace."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

from cspdiag.base.record import EMPTY, record
from cspdiag.runtime.deadlock.reports import DeadlockReport
from cspdiag.verify.guided.script import Actor, Happened, Standing
from cspdiag.verify.replay.rest import Resting
from cspdiag.verify.replay.rounds import Added

Judge: TypeAlias = Callable[[Sequence[tuple[str, Any]], Resting | None], str | None]
"""What is wrong with a run, from its communications and the state of the processes after it; None if nothing is."""


@record
class Replay:
    """How far the program followed a trace.

    ``divergence`` says why it did not follow it to the end; None if it did. ``communications`` are (channel, value) in
    order; ``deadlock`` is the report of the runtime at the end.
    """

    steps: int
    divergence: str | None
    communications: tuple[tuple[str, Any], ...]
    deadlock: DeadlockReport | None = None
    excluded: bool = False
    """Whether priorities or times keep the program from following."""
    judgement: str = ""
    """What the judge has found wrong."""
    added: tuple[Added, ...] = ()
    """Rounds of loops that the trace does not have."""
    passed: Mapping[int, str] = EMPTY
    """What the environment offered, and was given where the trace leaves that open, by the number of the step."""
    actors: Mapping[int, tuple[Actor, ...]] = EMPTY
    """Who took part in the steps of the trace, and where, by the number of the step; only if there may be rounds."""
    other: tuple[Happened, ...] = ()
    """What the program did instead, if it has reached another standstill, or does more than the trace before everything
    is repeated.
    """
    other_round_from: int | None = None
    """The number of entries in ``other`` before what is repeated forever."""
    standing: tuple[Standing, ...] = ()
    """The tasks that wait forever after that."""
    instants: tuple[int, ...] = ()
    """The instants of the communications, in nanoseconds; empty if the program on its real runtime has them in another
    order.
    """
    round_from: int | None = None
    """The number of communications before those that are repeated forever; they end with the last.

    None if nothing is repeated.
    """
    repeated: tuple[int, int] | None = None
    """The number of rounds, and of nanoseconds, after which everything is as it was before."""

    @property
    def succeeded(self) -> bool:
        """Whether the program followed the whole trace."""
        return self.divergence is None
