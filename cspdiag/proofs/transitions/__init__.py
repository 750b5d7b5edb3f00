"""Networks as transition systems: what the proofs reason about."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.proofs.transitions.classes.told_apart import AsSpecification, ToldApart
    from cspdiag.proofs.transitions.systems.system import System


def transition_system(
    network: CoreNetwork, told_apart: ToldApart | None = None, specification: AsSpecification | None = None
) -> System:
    """The transition system of a network in the most general environment: any value, any event at any time, samples at
    their ticks.

    The network is one that was lowered and not optimized; its outermost process may be any. ``told_apart`` are ports of
    it whose values matter even where no condition of its own depends on them, as far as they are known. As a
    ``specification`` it is taken at its word: what it writes is followed, it never misses a sample, and where the
    system does more than it does itself, that is among the abstractions. Raises
    ``cspdiag.proofs.transitions.threads.explore.TransitionError`` for a program that has too many states in one of its
    processes, or too many ways to communicate on one channel.
    """
    from cspdiag.proofs.transitions.assembly import Assembly
    from cspdiag.proofs.transitions.classes.facts import Facts
    from cspdiag.proofs.transitions.classes.program import Program
    from cspdiag.proofs.transitions.occurrences import World
    from cspdiag.proofs.transitions.threads.threads import Strands
    from cspdiag.syntax.parse.nesting import room_to_recurse

    with room_to_recurse():
        program = Program(network)
        return Assembly(Strands(World(program, Facts(program, told_apart or {}, specification)))).system()
