"""Decides which replicated ``seq`` become a counted loop, whose index is a variable of the process."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from enum import Enum
from itertools import product
from math import prod

from cspdiag.base import Span
from cspdiag.base.record import node
from cspdiag.model.program import EndLabelSymbol, Program
from cspdiag.model.types import INT
from cspdiag.network.elaborate.constant_value import constant_value
from cspdiag.network.ir.actions import AssignValue, CoreAction, CountedLoop, SequentialSteps, Target
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import BinaryOperation, Expression, LiteralValue, VariableValue
from cspdiag.network.lower.distinct_names import DistinctNames
from cspdiag.network.shapes import ChannelShape, Shape
from cspdiag.syntax import ast
from cspdiag.syntax.walk import names, nodes

MOST_ALIKE_UNROLLED = 16
"""Identical iterations are unrolled up to this number; more of them are a loop."""

MOST_UNROLLED = 64
"""Iterations that differ only by values are unrolled up to this number; more of them are a loop.

If they are unrolled, checks and analyses know what each iteration does: a condition on the index selects parts of the
diagram, and a delay that depends on it is a constant. Unrolling 64 iterations of an alternative takes 1.5 times as long
to compile to C (``-O0``) as a loop, 250 iterations 3 times and 1,000 iterations 20 times as long.
"""


class IndexUse(Enum):
    """What the index of a replicator is used for in the repeated part."""

    NOTHING = "nothing"
    VALUES = "values"
    """It is used in computations, and to choose elements of values."""
    STRUCTURE = "structure"
    """It chooses ends, instances or sizes, which must be known when the network is made."""


@node
class IterationCounter:
    """The iterations of a loop, with the variable of the process that counts them."""

    number: int
    variable: ChannelShape

    def index(self, span: Span) -> VariableValue:
        """The index of the present iteration."""
        return VariableValue(type=INT, channel=self.variable.name, range=(0, self.number - 1), span=span)


class Indexes:
    """The indexes of the replicated sequences of a shape that become loops."""

    def __init__(self, program: Program, shape: Shape, loops: Mapping[ast.Node, tuple[ast.Replicator, ...]]) -> None:
        self.program = program
        self.shape = shape
        self._loops = loops
        """The replicators around each declaration."""
        self._uses: dict[ast.Replicator, IndexUse] = {}
        self._counting: dict[ast.Replicator, IterationCounter] = {}
        self._names: DistinctNames | None = None

    def iterations_around(self) -> int:
        """The product of the numbers of iterations of the loops around the present place."""
        return prod(counter.number for counter in self._counting.values())

    def use_in_loop(self, part: ast.Replicated, iterations: int) -> IndexUse | None:
        """What the index of a replicated ``seq`` that becomes a loop is used for; None if the ``seq`` is unrolled."""
        if part.operator != "seq" or iterations <= MOST_ALIKE_UNROLLED:
            return None
        use = self._use(part.replicator, part.process)
        most = {IndexUse.NOTHING: MOST_ALIKE_UNROLLED, IndexUse.VALUES: MOST_UNROLLED, IndexUse.STRUCTURE: iterations}
        return use if iterations > most[use] else None

    def value(self, name: ast.Name | ast.Reference) -> Expression | None:
        """The index that a name means, as the variable that counts it; None if no variable does."""
        symbol = self.program.bindings.get(name)
        counter = self._counting.get(symbol) if isinstance(symbol, ast.Replicator) else None
        return None if counter is None else counter.index(name.span)

    @contextmanager
    def counting(self, replicator: ast.Replicator, number: int) -> Iterator[IterationCounter]:
        """Makes a variable for the index, which counts while the repeated part is composed."""
        variable = ChannelShape(self._fresh(replicator.name.text), replicator, INT, replicator.name.span)
        variable.initial = LiteralValue(type=INT, value=0)
        variable.iterations = number
        self.shape.channels[variable.name] = variable
        counter = self._counting[replicator] = IterationCounter(number=number, variable=variable)
        yield counter
        del self._counting[replicator]

    def in_every_iteration(self, condition: Expression) -> bool | None:
        """Whether a condition on indexes alone holds in every iteration; None if it holds in some of them only, or
        depends on anything else.
        """
        counted = {part.channel: part.range for part in walk(condition) if isinstance(part, VariableValue)}
        ranges = [range(given[0], given[1] + 1) for given in counted.values() if given is not None]
        if len(ranges) < len(counted):
            return None
        found: bool | None = None
        for values in product(*ranges):
            value = constant_value(_with(condition, dict(zip(counted, values, strict=True))), lambda _: None)
            if not isinstance(value, bool) or found not in (None, value):
                return None
            found = value
        return found

    def _use(self, replicator: ast.Replicator, process: ast.Composition) -> IndexUse:
        known = self._uses.get(replicator)
        if known is None:
            known = IndexUse.NOTHING
            for part in nodes(process):
                if self.program.bindings.get(part) is replicator:
                    known = IndexUse.VALUES
            if any(self.program.bindings.get(name) is replicator for name in names(self._structural(process))):
                known = IndexUse.STRUCTURE
            self._uses[replicator] = known
        return known

    def _structural(self, process: ast.Composition) -> Iterator[ast.Expression]:
        """The expressions whose values must be known when the network is made.

        These include conditions of parts that other iterations may not have and that a loop cannot leave out: guards,
        parts of parallels, first assignments to variables.
        """
        begins_unset = any(c.is_variable and c.initial is None for c in self.shape.channels.values())
        for part in nodes(process):
            match part:
                case ast.Replicator():
                    yield part.count
                case ast.Reference():
                    yield from self._choosing(part)
                case ast.Guard() if part.condition is not None:
                    yield part.condition
                case ast.Parallel() | ast.Interrupt() | ast.Replicated(operator="par" | "pripar"):
                    yield from (inner.condition for inner in nodes(part) if isinstance(inner, ast.If))
                case ast.If() if begins_unset:
                    yield part.condition
                case _:  # No other part affects the structure of the network.
                    pass

    def _choosing(self, reference: ast.Reference) -> tuple[ast.Expression, ...]:
        """The indexes that choose what a reference means; further indexes of a variable choose an element of
        its value.
        """
        symbol = self.program.bindings.get(reference)
        declaration = symbol.connection if isinstance(symbol, EndLabelSymbol) else symbol
        if isinstance(declaration, ast.Variable | ast.Connection):
            return reference.indexes[: len(self._loops.get(declaration, ()))]
        return (*reference.indexes, *reference.member_indexes)

    def _fresh(self, wanted: str) -> str:
        """A name that is unique in the class."""
        if self._names is None:
            parameters = (parameter.name.text for parameter in self.shape.definition.parameters)
            members = (*self.shape.ports, *self.shape.channels, *self.shape.instances)
            self._names = DistinctNames((*parameters, *(name.partition("[")[0] for name in members)))
        return self._names.fresh(wanted, lambda number: f"{wanted}_{number}")


def counted_loop(part: ast.Replicated, counter: IterationCounter, body: CoreAction) -> CoreAction:
    """A counted loop: the index is 0 in the first iteration, and one more in each further one.

    Both assignments have the span of the index, of which the first is reached: so if an iteration never ends, the
    second is not reported as unreachable.
    """
    span, target = part.replicator.span, Target(counter.variable.name)
    zero, one = (LiteralValue(type=INT, value=value, span=span) for value in (0, 1))
    more = BinaryOperation(type=INT, span=span, operator="+", left=counter.index(span), right=one)
    steps = (body, AssignValue(span=span, target=target, value=more))
    loop = CountedLoop(span=part.place, body=SequentialSteps(span=part.place, steps=steps), iterations=counter.number)
    return SequentialSteps(span=part.place, steps=(AssignValue(span=span, target=target, value=zero), loop))


def _with(condition: Expression, indexes: Mapping[str, int]) -> Expression:
    def change(part: object) -> object:
        return LiteralValue(type=INT, value=indexes[part.channel]) if isinstance(part, VariableValue) else part

    return rewritten(condition, change)
