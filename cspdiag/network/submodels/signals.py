"""The signals of a submodel: what the names in its equations mean in the system that it becomes part of.

``pid.error`` is the input ``error`` of the instance ``pid``. A parameter of an instance becomes a constant ``pid.kp``,
unless its argument is a name itself, which then replaces it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import assert_never

from cspdiag.base import Report, Span
from cspdiag.base.record import node
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.program import BuiltinSymbol, EndLabelSymbol, EnumLiteralSymbol, PortSymbol, Program, Scope, Value
from cspdiag.model.types import ArrayType, RealType, TimeType, Type
from cspdiag.network.diagnostics.arrays import IndexOutOfRange
from cspdiag.network.diagnostics.submodels import TimeOutsideEnvironment
from cspdiag.network.elaborate.expression import LoweringContext, in_seconds, lower_expression
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expressions import (
    ArrayElements,
    Expression,
    LiteralValue,
    ParameterValue,
    PresentTime,
    SignalValue,
    TunableValue,
)
from cspdiag.network.submodels.draft import SECONDS, Draft
from cspdiag.syntax import ast

MOST_ELEMENTS = 20_000
NO_VALUES: Mapping[ast.Node, Value] = {}


@node
class InlinedInto:
    """Where a definition is inlined: the definitions that contain it, and whether it may use ``time``."""

    path: tuple[ast.SubmodelDefinition, ...]
    environment: bool


class SubmodelSignals:
    """The signals of one instance of a submodel within a draft.

    ``prefix`` is empty or ends in a dot. ``parameters`` are the arguments in terms of the draft; a parameter without an
    argument stays a parameter of the class.
    """

    def __init__(
        self,
        program: Program,
        draft: Draft,
        definition: ast.SubmodelDefinition,
        report: Report,
        surroundings: InlinedInto,
        prefix: str,
    ) -> None:
        self.program = program
        self.draft = draft
        self.definition = definition
        self.report = report
        self.surroundings = surroundings
        self.prefix = prefix
        self.parameters: dict[ast.Parameter, Expression] = {}
        self.scope = program.scopes.get(definition) or Scope()
        self.context = LoweringContext(values={}, lower_name=self.lower_name, lower_call=self.lower_call)

    def instance(self, name: str) -> SubmodelSignals | None:
        """The instance with this name inside this one."""
        raise NotImplementedError

    def refuse_instance(self, name: str, indexes: Sequence[ast.Expression]) -> None:
        """Handles an instance that does not exist inside this one."""
        raise NotImplementedError

    def lower_call(self, expression: ast.Call) -> Expression | None:
        """The value of a call of an operator with memory; None for a function."""
        raise NotImplementedError

    def ports(self, direction: str) -> Iterator[tuple[PortSymbol, str, Type]]:
        """The ports of one direction, element by element, with the names and types of their signals."""
        for symbol in self.scope.ports.values():
            if symbol.declaration.direction == direction:
                kind = self.declared(symbol.declaration.type, symbol.type)
                for key in self.elements(symbol):
                    yield symbol, self.prefix + key, kind

    def elements(self, symbol: PortSymbol) -> list[str]:
        """The names of the elements of an array of ports, or of a single port."""
        if not symbol.port.dimensions:
            return [symbol.name]
        total = math.prod(self.size(dimension) for dimension in symbol.port.dimensions)
        return [f"{symbol.name}[{index}]" for index in range(total)]

    def size(self, expression: ast.Expression) -> int:
        """The value of a size; 1 if it is not known, as when the definition is checked by itself."""
        self.draft.depends = self.draft.depends or not isinstance(expression, ast.Number)
        value = self.draft.value_of(lower_expression(self.program, expression, self.context))
        return value if isinstance(value, int) and 0 < value < MOST_ELEMENTS else 1

    def declared(self, written: ast.TypeName, known: Type) -> Type:
        """A declared type with its parameter-dependent sizes filled in."""
        if not written.dimensions:
            return known
        for _ in written.dimensions:
            known = known.element if isinstance(known, ArrayType) else known
        for dimension in reversed(written.dimensions):
            known = ArrayType(known, self.size(dimension))
        return known

    def constant(self, expression: ast.Expression) -> Expression:
        """Lowers an expression over parameters and constants, which is computed before the program runs; reports it if
        that fails.
        """
        self.examine(expression)
        return lower_expression(self.program, expression, self.context)

    def examine(self, expression: ast.Expression, replicators: Mapping[ast.Node, Value] = NO_VALUES) -> None:
        """Reports errors in an expression that is computed before the program runs, once the parameters are known."""
        if self.draft.concrete and not isinstance(expression, ast.Number | ast.Duration | ast.Boolean):
            self.draft.depends = self.draft.depends or not isinstance(expression, ast.Name)
            known: dict[ast.Node, Value] = dict(self.program.tunable.items())
            evaluate(self.program, expression, {**known, **self._values(), **replicators}, self.report)

    def _values(self) -> dict[ast.Node, Value]:
        """The values of the parameters of the definition."""
        values: dict[ast.Node, Value] = {}
        for parameter in self.definition.parameters:
            argument = self.parameters.get(parameter)
            given = self.draft.arguments.get(parameter.name.text)
            value = given if argument is None else self.draft.probed(argument)
            if value is not None:
                values[parameter] = value
        return values

    def index(self, expression: ast.Expression) -> int:
        """The value of an index."""
        value = self.draft.value_of(self.constant(expression))
        return value if isinstance(value, int) else 0

    def refuse_index(self, expression: ast.Expression, what: str, size: int, declared: Span) -> None:
        """Reports an index out of the range of an array of ports or instances."""
        self.draft.complete = False
        if self.draft.concrete:
            self.report.add(
                IndexOutOfRange(
                    span=expression.span, index=self.index(expression), what=what, size=size, declared=declared
                )
            )

    def lower_name(self, use: ast.Name | ast.Member | ast.Reference) -> Expression | None:
        """The expression that a name in an equation means; None for constants, replicators and literals of enums."""
        if isinstance(use, ast.Member):
            return self._port_of_instance(use)
        symbol = self.program.bindings.get(use)
        match symbol:
            case ast.Parameter():
                return self._parameter(symbol, use)
            case PortSymbol():
                return self._port(symbol, use.span)
            case ast.Let():
                kind = self.program.types.get(symbol, SECONDS)
                defined = self.draft.equations.get(self.prefix + symbol.name.text)
                if isinstance(defined, SubmodelEquation):
                    kind = defined.type
                return SignalValue(type=kind, name=self.prefix + symbol.name.text, span=use.span)
            case ast.State():
                kind = self.declared(symbol.type, self.program.types.get(symbol, SECONDS))
                return SignalValue(type=kind, name=self.prefix + symbol.name.text, span=use.span)
            case BuiltinSymbol(name="sample"):
                return self.draft.sample_period()
            case BuiltinSymbol(name="time"):
                if not self.surroundings.environment:
                    self.report.add(TimeOutsideEnvironment(use.span, self.definition.name.text))
                return PresentTime(type=SECONDS, span=use.span)
            case (
                ast.Constant() | ast.TypeAliasDefinition() | ast.EnumDefinition() | ast.StructDefinition()
                | ast.ExceptionDefinition() | ast.ProcessDefinition() | ast.SubmodelDefinition()
                | ast.DriverDefinition() | ast.EnvironmentDefinition() | ast.Variable() | ast.Channel()
                | ast.Instance() | ast.Replicator() | EndLabelSymbol() | EnumLiteralSymbol() | BuiltinSymbol() | None
            ):  # fmt: skip
                return None
            case _:
                assert_never(symbol)

    def _parameter(self, parameter: ast.Parameter, use: ast.Node) -> Expression:
        argument = self.parameters.get(parameter)
        kind = self.declared(parameter.type, self.program.types.get(parameter, SECONDS))
        if argument is None:
            own = TunableValue if parameter.name.text in self.draft.tunable else ParameterValue
            return own(type=kind, name=parameter.name.text, span=use.span)
        wanted = self.program.types.get(use, kind)
        is_seconds = isinstance(kind, TimeType) and isinstance(wanted, RealType)
        if _is_name(argument) or (isinstance(kind, TimeType) and not is_seconds):
            return argument
        name = self.prefix + parameter.name.text
        if name not in self.draft.equations:
            value = in_seconds(argument, wanted) if is_seconds else argument
            self.draft.equation(name, value, parameter.span, parameter.doc, wanted if is_seconds else kind)
        return SignalValue(type=wanted if is_seconds else kind, name=name, span=use.span)

    def _port(self, symbol: PortSymbol, span: Span) -> Expression:
        kind = self.declared(symbol.declaration.type, symbol.type)
        signals: list[Expression] = [
            SignalValue(type=kind, name=self.prefix + name, span=span) for name in self.elements(symbol)
        ]
        for dimension in reversed(symbol.port.dimensions):
            size = self.size(dimension)
            kind = ArrayType(kind, size)
            rows = [tuple(signals[start : start + size]) for start in range(0, len(signals), size)]
            signals = [ArrayElements(type=kind, values=row, span=span) for row in rows]
        return signals[0]

    def _port_of_instance(self, use: ast.Member) -> Expression | None:
        symbol = self.program.members.get(use)
        if not isinstance(symbol, PortSymbol):
            return None
        chosen: list[ast.Expression] = []
        instance = use.value
        while isinstance(instance, ast.Index):
            chosen.insert(0, instance.index)
            instance = instance.value
        if not isinstance(instance, ast.Name):
            return None
        owner = self.instance(instance.name + "".join(f"[{self.index(index)}]" for index in chosen))
        if owner is None:
            self.refuse_instance(instance.name, chosen)
            return None
        return owner._port(symbol, use.span)


def _is_name(expression: Expression) -> bool:
    """Whether an argument is a name, which may be used in many places."""
    if isinstance(expression, LiteralValue):
        return expression.name is not None
    return isinstance(expression, ParameterValue | TunableValue | SignalValue)
