"""How a program followed a trace."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

from cspdiag.base.record import EMPTY, record
from cspdiag.runtime.deadlock import DeadlockReport
from cspdiag.verify.guided.script import Happened, Standing
from cspdiag.verify.replay.rest import Resting
from cspdiag.verify.replay.rounds import Added

Judge: TypeAlias = Callable[[Sequence[tuple[str, Any]], Resting | None], str | None]
"""Says what is wrong with a run, from its communications and how the processes stand then; None if nothing is."""


@record
class Replay:
    """How far the program followed a trace.

    ``divergence`` says why it did not to the end; None if it did. ``communications`` are (channel, value) in order;
    ``deadlock`` is what the runtime says at the end.
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
    other: tuple[Happened, ...] = ()
    """What the program did instead, where it has come to a standstill in another way, or does more than the trace
    before everything is repeated.
    """
    other_round_from: int | None = None
    """The number of those in ``other`` before what is repeated for ever."""
    standing: tuple[Standing, ...] = ()
    """Who waits for ever after that."""
    instants: tuple[int, ...] = ()
    """When the communications were, in nanoseconds; nothing where the program as it runs has them in another order."""
    round_from: int | None = None
    """The number of communications before those that are repeated for ever; they end with the last.

    None where nothing is repeated.
    """
    repeated: tuple[int, int] | None = None
    """After so many rounds and so many nanoseconds everything is as it was before."""

    @property
    def succeeded(self) -> bool:
        """Whether the program did all of it."""
        return self.divergence is None
