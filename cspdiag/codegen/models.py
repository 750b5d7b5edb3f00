"""Models for other proof tools: what is written is the transition system of the network."""

from __future__ import annotations

from cspdiag.analyses.transitions.system import System
from cspdiag.codegen.target_error import TargetError
from cspdiag.network.ir import Network


def system_of(network: Network) -> System:
    """The transition system of a network. Raises TargetError where it would have too many states."""
    from cspdiag.analyses.transitions import transition_system
    from cspdiag.analyses.transitions.explore import TransitionError

    try:
        return transition_system(network)
    except TransitionError as problem:
        raise TargetError(str(problem)) from None
