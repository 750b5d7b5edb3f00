"""The passes of ``-O1``, each a pure function from network to network.

Each pass keeps what every process communicates, when, and how it ends.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import cast

from cspdiag.base.record import node, replaced
from cspdiag.network.elaborate.fewer.extrapolation import Extrapolation, IrregularError
from cspdiag.network.ir.expressions import Expression, LiteralValue, Typed
from cspdiag.network.ir.faults import operation_may_fault
from cspdiag.network.ir.network import Continued, CoreNetwork, FewerElements, Network
from cspdiag.network.ir.walk import parts
from cspdiag.optimize.bookkeeping import drop_bookkeeping
from cspdiag.optimize.check.network import require_valid
from cspdiag.optimize.constants.folding import fits, folded
from cspdiag.optimize.constants.propagation import fold_constants, fold_constants_alike
from cspdiag.optimize.dead.steps import remove_dead_parts
from cspdiag.optimize.flatten.processes import flatten
from cspdiag.optimize.fuse.program import explain_fusion, fuse
from cspdiag.optimize.inline_laws import inline_laws
from cspdiag.optimize.specialize import specialize
from cspdiag.optimize.variables import variables
from cspdiag.syntax.parse.nesting import raised_recursion_limit

__all__ = [
    "PASSES",
    "PASSES_FOR_LOOPS",
    "Pass",
    "explain_fusion",
    "lower_for_targets",
    "optimize",
    "pass_named",
    "with_all_elements",
]


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


PASSES_FOR_LOOPS: tuple[Pass, ...] = tuple(
    replaced(entry, apply=fold_constants_alike) if entry.name == "constants" else entry for entry in PASSES
)
"""The same for a target that writes steps which differ only in numbers as a loop, so they have to stay alike."""


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
    pass. A network with fewer elements than its program gets all of them.
    """
    if network.fewer is not None:
        try:
            return _following_from_fewer(network, network.fewer, passes, debug=debug)
        except IrregularError:
            whole = network.fewer.whole()
            assert whole is not None
            network = whole
    applied: list[str] = []
    if debug:
        require_valid(network)
    for entry in passes:
        network = entry.apply(network)
        applied.append(entry.name)
        if debug:
            require_valid(network, applied)
    return network


def with_all_elements(network: CoreNetwork) -> CoreNetwork:
    """The network, not optimized, with as many elements as its program has."""
    return cast("CoreNetwork", optimize(network, ()))


def _following_from_fewer(network: Network, fewer: FewerElements, passes: Sequence[Pass], *, debug: bool) -> Network:
    """The network of all elements after the passes. Raises IrregularError if that does not follow from fewer.

    Flattening looks at sizes, so where it does anything, nothing follows. To fuse processes is to follow all of them.
    """
    few: Network = fewer.network
    some = replaced(network, fewer=None)
    _require_same_decisions(few, some, fewer.sizes)
    for entry in (entry for entry in passes if entry.name != "fuse"):
        before = some
        few, some = (optimize(one, (entry,), debug=debug) for one in (few, some))
        if entry.name == "flatten" and some != before:
            raise IrregularError
    _require_same_decisions(few, some, fewer.sizes)
    whole = Extrapolation(*fewer.sizes).of(few, some)
    result = optimize(whole, [entry for entry in passes if entry.name == "fuse"], debug=debug)
    return replaced(whole, continued=Continued(few=few, some=some, sizes=fewer.sizes)) if result is whole else result


def _require_same_decisions(few: Network, some: Network, sizes: tuple[int, int, int]) -> None:
    """Raises IrregularError if expressions with the numbers of other elements could be folded, or fault, where these
    cannot, or the other way round.
    """
    first, second, all_ = sizes
    ends = (Extrapolation(first, second, size, only_ends=True).of(few.classes, some.classes) for size in (second, all_))
    if len({tuple(map(_decided, _expressions(classes))) for classes in ends}) > 1:
        raise IrregularError


def _expressions(classes: object) -> Iterator[Expression]:
    # Every typed part of a network is an expression, of which `Expression` is the union.
    return (cast("Expression", part) for part in parts(classes) if isinstance(part, Typed))


def _decided(expression: Expression) -> tuple[bool, bool, bool]:
    """What passes may ask of an expression that depends on its numbers."""
    return (
        operation_may_fault(expression),
        folded(expression) == expression,
        not isinstance(expression, LiteralValue) or fits(expression.value, expression.type),
    )


def lower_for_targets(network: Network) -> Network:
    """The network with what every compiled target needs: media of ports, names of alternatives, order of creation."""
    return optimize(network, (pass_named("specialize"),))
