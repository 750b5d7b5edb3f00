"""How a guided run went."""

from __future__ import annotations

from typing import Any

from cspdiag.base.record import record
from cspdiag.runtime.deadlock.reports import DeadlockReport
from cspdiag.verify.guided.script import Happened, Standing


@record
class GuidedRun:
    """How a run went: ``done`` entries of its script, ``actions`` of processes, and why it has not reached its goal,
    None if it has.

    ``cut`` is the number of decisions after which it left the script.
    """

    done: int
    actions: int
    divergence: str | None
    communications: tuple[tuple[str, Any], ...]
    deadlock: DeadlockReport | None
    cut: int
    happened: tuple[Happened, ...] = ()
    """All that was done, if it has reached another standstill than that of the script, or does more than the script
    before everything is repeated.
    """
    standing: tuple[Standing, ...] = ()
    """The tasks that then wait forever."""
    instants: tuple[int, ...] = ()
    """The instants of the communications, in nanoseconds."""
    repeated: tuple[int, int] | None = None
    """The number of rounds, and of nanoseconds, after which everything is as it was before; None if nothing is
    repeated.
    """

    round_from: int | None = None
    """The number of entries in ``happened`` before what is repeated forever; they end with one round of it."""

    @property
    def succeeded(self) -> bool:
        """Whether it has reached its goal in the way of the script."""
        return self.divergence is None
