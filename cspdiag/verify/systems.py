"""The transition systems of the processes in question, each made once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cspdiag.base.errors import CspdiagError
from cspdiag.obligations import ProofObligations
from cspdiag.proofs.transitions import transition_system
from cspdiag.proofs.transitions.classes.distinguished import AsSpecification, Distinction
from cspdiag.proofs.transitions.threads.explore import TransitionError

if TYPE_CHECKING:
    from cspdiag.proofs.transitions.classes.distinguished import Distinguished
    from cspdiag.proofs.transitions.systems.system import System


class VerificationError(CspdiagError):
    """A question that cannot be answered at all; the message is one line."""


class SystemCache:
    """The transition systems of the processes of a program."""

    def __init__(self, obligations: ProofObligations) -> None:
        self._obligations = obligations
        self._made: dict[tuple[str, frozenset[tuple[str, Distinction]], AsSpecification | None], System] = {}

    def of(
        self, process: str, distinguished: Distinguished | None = None, specification: AsSpecification | None = None
    ) -> System:
        """The transition system of a process of the program; see ``transition_system``.

        Raises VerificationError if the process alone has too many states.
        """
        ports = distinguished or {}
        key = process, frozenset(ports.items()), specification
        if key not in self._made:
            network = self._obligations.network(process)
            assert network is not None, "asked for a process with errors"
            try:
                self._made[key] = transition_system(network, ports, specification)
            except TransitionError as problem:
                raise VerificationError(str(problem)) from problem
        return self._made[key]
