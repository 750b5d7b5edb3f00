"""The passes of ``-O1``, each a pure function from network to network.

Each pass keeps what every process communicates, when, and how it ends.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from cspdiag.base.record import node
from cspdiag.network.ir.network import Network
from cspdiag.optimize.bookkeeping import drop_bookkeeping
from cspdiag.optimize.check.network import require_valid
from cspdiag.optimize.constants import fold_constants
from cspdiag.optimize.dead.steps import remove_dead_parts
from cspdiag.optimize.flatten.processes import flatten
from cspdiag.optimize.fuse.program import explain_fusion, fuse
from cspdiag.optimize.inline_laws import inline_laws
from cspdiag.optimize.specialize import specialize
from cspdiag.optimize.variables import variables
from cspdiag.syntax.parse.nesting import raised_recursion_limit

__all__ = ["PASSES", "Pass", "explain_fusion", "lower_for_targets", "optimize", "pass_named"]


@node
class Pass:
    """A step of optimization; ``description`` is one line for people."""

    name: str
    description: str
    apply: Callable[[Network], Network]


PASSES: tuple[Pass, ...] = (
    Pass(
        name="specialize",
        description="A class for each combination of media that its ports are connected to; alternatives get names.",
        apply=specialize,
    ),
    Pass(
        name="variables",
        description="Communication over `var` channels becomes assignment.",
        apply=variables,
    ),
    Pass(
        name="inline_laws",
        description="Control laws are computed by the process that runs them, with their states next to its variables.",
        apply=inline_laws,
    ),
    Pass(
        name="flatten",
        description="Processes that run in sequence become part of the process around them.",
        apply=flatten,
    ),
    Pass(
        name="constants",
        description=(
            "Parameters that are equal in all instances of a class, and what follows from them, become literals."
        ),
        apply=fold_constants,
    ),
    Pass(
        name="dead",
        description=(
            "What has no effect is removed: steps, handlers, equations, states, variables, ports, channels, classes."
        ),
        apply=remove_dead_parts,
    ),
    Pass(
        name="bookkeeping",
        description=(
            "Alternatives that need no memory take the first guard, parallels that need no priorities keep none."
        ),
        apply=drop_bookkeeping,
    ),
    Pass(
        name="fuse",
        description=(
            "A program whose schedule is known becomes one process: a beginning, and a loop with what is repeated."
        ),
        apply=fuse,
    ),
)
"""In the order in which they run; a pass may rely on those before it."""


def pass_named(name: str) -> Pass:
    """The pass of that name. Raises KeyError."""
    for entry in PASSES:
        if entry.name == name:
            return entry
    raise KeyError(name)


@raised_recursion_limit()
def optimize(network: Network, passes: Sequence[Pass] = PASSES, *, debug: bool = False) -> Network:
    """The network after the passes, in the order given.

    With ``debug`` it is verified before the first pass and after each one; raises BrokenNetworkError, which names the
    pass.
    """
    applied: list[str] = []
    if debug:
        require_valid(network)
    for entry in passes:
        network = entry.apply(network)
        applied.append(entry.name)
        if debug:
            require_valid(network, applied)
    return network


def lower_for_targets(network: Network) -> Network:
    """The network with what every compiled target needs: media of ports, names of alternatives, order of creation."""
    return optimize(network, (pass_named("specialize"),))
