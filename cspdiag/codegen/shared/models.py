"""Models for other proof tools: the transition system of the network in their languages."""

from __future__ import annotations

from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.transitions.systems.system import System


def system_of(network: CoreNetwork) -> System:
    """The transition system of a network. Raises TargetError if it would have too many states."""
    from cspdiag.proofs.transitions import transition_system
    from cspdiag.proofs.transitions.threads.explore import TransitionError

    try:
        return transition_system(network)
    except TransitionError as problem:
        raise TargetError(str(problem)) from None
