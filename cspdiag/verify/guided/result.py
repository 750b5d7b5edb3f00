"""How a guided run went."""

from __future__ import annotations

from typing import Any

from cspdiag.base.record import record
from cspdiag.runtime.deadlock import DeadlockReport
from cspdiag.verify.guided.script import Happened, Standing


@record
class GuidedRun:
    """How a run went: ``done`` entries of its script, ``actions`` of processes, and why it has not reached its goal,
    None if it has.

    ``cut`` is the number of decisions after which it was lost.
    """

    done: int
    actions: int
    divergence: str | None
    communications: tuple[tuple[str, Any], ...]
    deadlock: DeadlockReport | None
    cut: int
    happened: tuple[Happened, ...] = ()
    """All that was done, where it has come to a standstill in another way than the script has, or does more than the
    script before everything is repeated.
    """
    standing: tuple[Standing, ...] = ()
    """Who waits for ever then."""
    instants: tuple[int, ...] = ()
    """When the communications were, in nanoseconds."""
    repeated: tuple[int, int] | None = None
    """After so many rounds and so many nanoseconds everything is as it was before; None where nothing is repeated."""

    round_from: int | None = None
    """The number of those in ``happened`` before what is repeated for ever; they end with one round of it."""

    @property
    def succeeded(self) -> bool:
        """Whether it has reached its goal as the script has it."""
        return self.divergence is None
