"""The answers to whether a run continues forever with certain events only."""

from __future__ import annotations

from cspdiag.base.record import record
from cspdiag.proofs.verdict import Method, Move


@record
class Endless:
    """A run that never ends: ``trace`` from the initial state, then ``cycle`` forever."""

    method: Method
    trace: tuple[Move, ...]
    cycle: tuple[Move, ...]
    states: int | None = None


@record
class Finite:
    """No run has infinitely many of the events in a row; ``states`` is the number of states explored, None if none had
    to be.
    """

    method: Method
    states: int | None = None
