"""The turns of a replicated ``seq`` as one loop that counts: where its index may be a variable of the process."""

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
"""Turns that are all the same and written down one by one; more of them are a loop."""

MOST_UNROLLED = 64
"""Turns that differ only by values and are written down one by one; more of them are a loop.

With the index known, checks and analyses know what each turn does: a condition on it decides which parts of a diagram
there are, and a delay by it is a constant. Unrolled, 64 turns of an alternative take half as long again to compile to C
(``-O0``) as a loop, 250 three and 1,000 twenty times as long.
"""


class IndexUse(Enum):
    """What the index of a replicator is used for in what is repeated."""

    NOTHING = "nothing"
    VALUES = "values"
    """It is computed with, and chooses elements of values."""
    STRUCTURE = "structure"
    """It chooses ends, instances or sizes, which are known when the network is made."""


@node
class Turns:
    """The turns that an index counts in a variable of the process."""

    number: int
    variable: ChannelShape

    def index(self, span: Span) -> VariableValue:
        """The index in a turn."""
        return VariableValue(type=INT, channel=self.variable.name, range=(0, self.number - 1), span=span)


class Indexes:
    """The indexes of those replicated sequences of a shape that are loops."""

    def __init__(self, program: Program, shape: Shape, loops: Mapping[ast.Node, tuple[ast.Replicator, ...]]) -> None:
        self.program = program
        self.shape = shape
        self._loops = loops
        """The replicators around each declaration."""
        self._uses: dict[ast.Replicator, IndexUse] = {}
        self._counting: dict[ast.Replicator, Turns] = {}
        self._names: DistinctNames | None = None

    def turns_around(self) -> int:
        """How many turns of loops the present place is gone through in."""
        return prod(turns.number for turns in self._counting.values())

    def use_in_loop(self, part: ast.Replicated, turns: int) -> IndexUse | None:
        """What the index of a replicated ``seq`` that is to be a loop is used for; None where it is unrolled."""
        if part.operator != "seq" or turns <= MOST_ALIKE_UNROLLED:
            return None
        use = self._use(part.replicator, part.process)
        most = {IndexUse.NOTHING: MOST_ALIKE_UNROLLED, IndexUse.VALUES: MOST_UNROLLED, IndexUse.STRUCTURE: turns}
        return use if turns > most[use] else None

    def value(self, name: ast.Name | ast.Reference) -> Expression | None:
        """The index that a name means, if a variable counts it here."""
        symbol = self.program.bindings.get(name)
        turns = self._counting.get(symbol) if isinstance(symbol, ast.Replicator) else None
        return None if turns is None else turns.index(name.span)

    @contextmanager
    def counting(self, replicator: ast.Replicator, number: int) -> Iterator[Turns]:
        """A variable for the index, while what is repeated is composed."""
        variable = ChannelShape(self._fresh(replicator.name.text), replicator, INT, replicator.name.span)
        variable.initial = LiteralValue(type=INT, value=0)
        variable.turns = number
        self.shape.channels[variable.name] = variable
        turns = self._counting[replicator] = Turns(number=number, variable=variable)
        yield turns
        del self._counting[replicator]

    def in_every_turn(self, condition: Expression) -> bool | None:
        """Whether a condition over indexes alone holds; None if it holds in some turns only, or if it is over more."""
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
        """The expressions that have to be known when the network is made.

        Conditions are among them by which a turn has parts that could not stand beside those of other turns: guards,
        parts in parallel, what gives a variable its first value.
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
                case _:  # Nothing else decides what there is in the network.
                    pass

    def _choosing(self, reference: ast.Reference) -> tuple[ast.Expression, ...]:
        """The indexes that choose what a reference means; of a variable, others choose an element of its value."""
        symbol = self.program.bindings.get(reference)
        declaration = symbol.connection if isinstance(symbol, EndLabelSymbol) else symbol
        if isinstance(declaration, ast.Variable | ast.Connection):
            return reference.indexes[: len(self._loops.get(declaration, ()))]
        return (*reference.indexes, *reference.member_indexes)

    def _fresh(self, wanted: str) -> str:
        """A name that nothing else in the class has."""
        if self._names is None:
            parameters = (parameter.name.text for parameter in self.shape.definition.parameters)
            members = (*self.shape.ports, *self.shape.channels, *self.shape.instances)
            self._names = DistinctNames((*parameters, *(name.partition("[")[0] for name in members)))
        return self._names.fresh(wanted, lambda number: f"{wanted}_{number}")


def counted_loop(part: ast.Replicated, turns: Turns, body: CoreAction) -> CoreAction:
    """A loop that counts: the index is 0 in the first turn, and one more in each other.

    Both assignments have the place of the index, and the first is reached: where a turn never ends, it is not reported
    that the second is unreachable.
    """
    span, target = part.replicator.span, Target(turns.variable.name)
    zero, one = (LiteralValue(type=INT, value=value, span=span) for value in (0, 1))
    more = BinaryOperation(type=INT, span=span, operator="+", left=turns.index(span), right=one)
    steps = (body, AssignValue(span=span, target=target, value=more))
    loop = CountedLoop(span=part.span, body=SequentialSteps(span=part.span, steps=steps), turns=turns.number)
    return SequentialSteps(span=part.span, steps=(AssignValue(span=span, target=target, value=zero), loop))


def _with(condition: Expression, indexes: Mapping[str, int]) -> Expression:
    def change(part: object) -> object:
        return LiteralValue(type=INT, value=indexes[part.channel]) if isinstance(part, VariableValue) else part

    return rewritten(condition, change)
