"""A question about a system, with what several methods need to answer it."""

from __future__ import annotations

from functools import cached_property

from cspdiag.base.record import record
from cspdiag.proofs.structure.pairs import Structure
from cspdiag.proofs.structure.traps import Traps
from cspdiag.proofs.structure.waiting import WaitingOrder, waiting_states
from cspdiag.proofs.transitions.systems.system import System


@record
class StuckQuestion:
    """Whether a system is free from deadlock (``together``: all components wait), or from knots. ``structure`` may be
    given if it is known.
    """

    system: System
    together: bool
    known: Structure | None = None

    @cached_property
    def structure(self) -> Structure:
        """The system by shapes and pairs."""
        return self.known or Structure(self.system)

    @cached_property
    def waiting(self) -> WaitingOrder:
        """The waiting states that are not excluded by orders of waiting."""
        return waiting_states(self.structure, together=self.together)

    @cached_property
    def traps(self) -> Traps:
        """The traps of the system."""
        return Traps(self.structure)
