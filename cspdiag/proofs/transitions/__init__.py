"""Networks as transition systems: what the proofs reason about."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.proofs.transitions.classes.distinguished import AsSpecification, Distinguished
    from cspdiag.proofs.transitions.systems.system import System


def transition_system(
    network: CoreNetwork, distinguished: Distinguished | None = None, specification: AsSpecification | None = None
) -> System:
    """The transition system of a network in the most general environment: any value, any event at any time, samples at
    their ticks.

    The network is lowered and not optimized; any of its processes may be the outermost one. ``distinguished`` says by
    port how closely values are distinguished that no condition of the network depends on. In the system of a
    ``specification`` all values that it writes are followed, it never misses a sample, and the abstractions list what
    the system can do and the specification cannot. Raises
    ``cspdiag.proofs.transitions.threads.explore.TransitionError`` if one of its processes has too many states, or a
    channel too many possible communications.
    """
    from cspdiag.proofs.transitions.assembly import Assembly
    from cspdiag.proofs.transitions.classes.facts import Facts
    from cspdiag.proofs.transitions.classes.program import Program
    from cspdiag.proofs.transitions.occurrences import World
    from cspdiag.proofs.transitions.threads.threads import ThreadTree
    from cspdiag.syntax.parse.nesting import raised_recursion_limit

    with raised_recursion_limit():
        program = Program(network)
        return Assembly(ThreadTree(World(program, Facts(program, distinguished or {}, specification)))).system()
