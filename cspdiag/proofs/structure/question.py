"""The questions that several proof methods answer, with what they share."""

from __future__ import annotations

from functools import cached_property

from cspdiag.base.record import record
from cspdiag.proofs.structure.pairs import Structure
from cspdiag.proofs.structure.traps import Traps
from cspdiag.proofs.structure.waiting import WaitingOrder, waiting_states
from cspdiag.proofs.transitions.systems.system import System


@record
class StuckQuestion:
    """Whether a system is free from deadlock (``together``: all components wait) or from knots. ``known`` is its
    structure, if it has been computed already.
    """

    system: System
    together: bool
    known: Structure | None = None

    @cached_property
    def structure(self) -> Structure:
        """The shapes and pairs of the system."""
        return self.known or Structure(self.system)

    @cached_property
    def waiting(self) -> WaitingOrder:
        """The waiting states that orders of waiting do not exclude."""
        return waiting_states(self.structure, together=self.together)

    @cached_property
    def traps(self) -> Traps:
        """The traps of the system."""
        return Traps(self.structure)
