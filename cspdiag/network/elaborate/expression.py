"""Lowers expressions of the text to expressions of the network: resolved, typed, without units.

A value stays a number in the unit of its type, so only ``convert`` becomes an operation, a multiplication. A ``time``
becomes ``seconds(...)`` where the model requires a real number, as in every equation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import assert_never, get_args

from cspdiag.base import Span
from cspdiag.base.record import node, replaced
from cspdiag.model.constants.arithmetic import single
from cspdiag.model.program import BuiltinSymbol, EndLabelSymbol, EnumLiteralSymbol, PortSymbol, Program
from cspdiag.model.types import (
    BOOL,
    TEXT,
    TIME,
    UNKNOWN,
    ArrayType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TimeType,
    Type,
)
from cspdiag.model.units import conversion_factor
from cspdiag.network.ir.expressions import (
    ArrayElements,
    BinaryOperation,
    ConditionalValue,
    Conversion,
    ElementValue,
    Expression,
    FieldValue,
    Function,
    FunctionCall,
    LiteralValue,
    ParameterValue,
    PresentTime,
    StructValue,
    TunableValue,
    UnaryOperation,
    Value,
)
from cspdiag.syntax import ast


def _nothing(_node: ast.Node) -> Expression | None:
    return None


@node
class LoweringContext:
    """What the names in an expression mean besides parameters and constants.

    ``values``: replicators, parameters or other symbols that become literals. ``lower_name`` is called first for every
    name, member and reference, ``lower_call`` for every call; they return None if the node has its usual meaning.
    """

    values: Mapping[ast.Node, Value]
    lower_name: Callable[[ast.Name | ast.Member | ast.Reference], Expression | None] = staticmethod(_nothing)
    lower_call: Callable[[ast.Call], Expression | None] = staticmethod(_nothing)


def lower_expression(program: Program, expression: ast.Expression, context: LoweringContext) -> Expression:
    """A checked expression as an expression of the network; a poisoned one becomes a literal of type Unknown."""
    return _Lowering(program, context).lower(expression)


def lower_period(program: Program, sampling: ast.Sampling | None, context: LoweringContext) -> Expression | None:
    """The period of a port, with the span of the whole declaration of its sample instants."""
    if sampling is None:
        return None
    return replaced(lower_expression(program, sampling.period, context), span=sampling.span)


def in_seconds(expression: Expression, wanted: Type) -> Expression:
    """The expression as a real number of seconds if it is a ``time`` and ``wanted`` is a real type; otherwise
    unchanged.
    """
    if not (isinstance(expression.type, TimeType) and isinstance(wanted, RealType)):
        return expression
    if isinstance(expression, LiteralValue) and expression.name is None:
        assert isinstance(expression.value, int)
        return LiteralValue(type=wanted, value=expression.value / 1_000_000_000, span=expression.span)
    return FunctionCall(type=wanted, function="seconds", arguments=(expression,), span=expression.span)


class _Lowering:
    def __init__(self, program: Program, context: LoweringContext) -> None:
        self.program = program
        self.context = context

    def lower(self, expression: ast.Expression) -> Expression:
        wanted = self.program.types.get(expression, UNKNOWN)
        if expression in self.program.poisoned:
            return _unknown(expression.span)
        match expression:
            case ast.Number():
                return _number(expression.value, wanted, expression.span)
            case ast.Duration():
                return _duration(expression, wanted)
            case ast.Boolean():
                return LiteralValue(type=BOOL, value=expression.value, span=expression.span)
            case ast.Text():
                return LiteralValue(type=TEXT, value=expression.value, span=expression.span)
            case ast.Name():
                return in_seconds(self.name(expression, wanted), wanted)
            case ast.Member():
                return in_seconds(self.member(expression, wanted), wanted)
            case ast.Index():
                return in_seconds(self.index(expression, wanted), wanted)
            case ast.Unary():
                return self.unary(expression, wanted)
            case ast.Binary():
                return self.binary(expression, wanted)
            case ast.Conditional():
                return ConditionalValue(
                    type=wanted,
                    span=expression.span,
                    condition=self.lower(expression.condition),
                    then=self.lower(expression.then),
                    otherwise=self.lower(expression.otherwise),
                )
            case ast.Call():
                return self.call(expression, wanted)
            case ast.ArrayValue():
                return _array(tuple(map(self.lower, expression.elements)), wanted, expression.span)
            case _:
                assert_never(expression)

    def name(self, expression: ast.Name, wanted: Type) -> Expression:
        found = self.context.lower_name(expression)
        return found if found is not None else self.symbol(expression, expression.span, wanted)

    def symbol(self, use: ast.Node, span: Span, wanted: Type) -> Expression:
        """The expression for the symbol that ``use`` is bound to: a parameter, a constant, a replicator or a literal of
        an enum.
        """
        symbol = self.program.bindings.get(use)
        match symbol:
            case ast.Parameter() if symbol not in self.context.values:
                declared = self.program.types.get(symbol, wanted)
                return ParameterValue(type=declared, name=symbol.name.text, span=span)
            case ast.Constant():
                declared = self.program.types.get(symbol, wanted)
                if symbol in self.program.tunable:
                    return TunableValue(type=declared, name=symbol.name.text, of_program=True, span=span)
                value = self.program.constants.get(symbol)
                if value is None:
                    return _unknown(span)
                return LiteralValue(type=declared, value=value, name=symbol.name.text, span=span)
            case BuiltinSymbol(name="pi"):
                return LiteralValue(type=wanted, value=math.pi, name="pi", span=span)
            case BuiltinSymbol(name="now"):
                return PresentTime(type=TIME, span=span)
            case EnumLiteralSymbol():
                return LiteralValue(type=wanted, value=symbol.index, span=span)
            case _ if isinstance(symbol, ast.Node) and symbol in self.context.values:
                declared = self.program.types.get(symbol, wanted)
                return LiteralValue(type=declared, value=self.context.values[symbol], span=span)
            case (
                ast.TypeAliasDefinition() | ast.EnumDefinition() | ast.StructDefinition() | ast.ExceptionDefinition()
                | ast.ProcessDefinition() | ast.SubmodelDefinition() | ast.DriverDefinition()
                | ast.EnvironmentDefinition() | ast.Parameter() | ast.Variable() | ast.Channel() | ast.Instance()
                | ast.Let() | ast.State() | ast.Replicator() | PortSymbol() | EndLabelSymbol() | BuiltinSymbol()
                | None
            ):  # fmt: skip
                return _unknown(span)
            case _:
                assert_never(symbol)

    def member(self, expression: ast.Member, wanted: Type) -> Expression:
        found = self.context.lower_name(expression)
        if found is not None:
            return found
        meant = self.program.members.get(expression)
        match meant:
            case EnumLiteralSymbol():
                return LiteralValue(type=wanted, value=meant.index, span=expression.span)
            case str():
                return _field(self.lower(expression.value), meant, expression.span)
            case PortSymbol() | None:
                return _unknown(expression.span)
            case _:
                assert_never(meant)

    def index(self, expression: ast.Index, wanted: Type) -> Expression:
        operand, index = self.lower(expression.value), self.lower(expression.index)
        return element(operand, index, wanted, expression.span)

    def unary(self, expression: ast.Unary, wanted: Type) -> Expression:
        operand = self.lower(expression.operand)
        if expression.operator == "-" and isinstance(operand, LiteralValue) and operand.name is None:
            assert isinstance(operand.value, int | float)
            return replaced(operand, value=-operand.value, span=expression.span)
        return UnaryOperation(type=wanted, span=expression.span, operator=expression.operator, operand=operand)

    def binary(self, expression: ast.Binary, wanted: Type) -> Expression:
        return BinaryOperation(
            type=wanted,
            span=expression.span,
            operator=expression.operator,
            left=self.lower(expression.left),
            right=self.lower(expression.right),
        )

    def call(self, expression: ast.Call, wanted: Type) -> Expression:
        found = self.context.lower_call(expression)
        if found is not None:
            return found
        callee = self.program.bindings.get(expression.function)
        if isinstance(callee, ast.StructDefinition):
            return self.struct(expression, wanted)
        name = callee.name if isinstance(callee, BuiltinSymbol) else expression.function.text
        if name == "convert":
            return self.convert(expression, wanted)
        arguments = tuple(self.lower(argument.value) for argument in expression.arguments)
        if name in get_args(Function):
            function: Function = name  # type: ignore[assignment]
            return FunctionCall(type=wanted, span=expression.span, function=function, arguments=arguments)
        if len(arguments) == 1 and isinstance(arguments[0].type, TimeType):
            return in_seconds(arguments[0], wanted)
        if len(arguments) == 1 and isinstance(wanted, IntType | RealType):
            return Conversion(type=wanted, span=expression.span, operand=arguments[0])
        return _unknown(expression.span)

    def convert(self, expression: ast.Call, wanted: Type) -> Expression:
        """Lowers ``convert(x, unit)`` to a multiplication by the ratio of the two units."""
        operand = self.lower(expression.arguments[0].value)
        operand = in_seconds(operand, wanted)
        if not (isinstance(operand.type, RealType) and isinstance(wanted, RealType)):
            return _unknown(expression.span)
        factor = conversion_factor(operand.type.unit, wanted.unit)
        if factor is None:
            return _unknown(expression.span)
        if factor == 1:
            return replaced(operand, type=wanted)
        if isinstance(operand, LiteralValue) and operand.name is None and isinstance(operand.value, float):
            return LiteralValue(type=wanted, value=operand.value * factor, span=expression.span)
        ratio = LiteralValue(type=RealType(wanted.bits), value=factor)
        return BinaryOperation(type=wanted, span=expression.span, operator="*", left=operand, right=ratio)

    def struct(self, expression: ast.Call, wanted: Type) -> Expression:
        if not isinstance(wanted, StructType):
            return _unknown(expression.span)
        names = [name for name, _ in wanted.fields]
        values: dict[str, Expression] = {}
        for position, argument in enumerate(expression.arguments):
            name = argument.name.text if argument.name else names[min(position, len(names) - 1)]
            values[name] = self.lower(argument.value)
        if any(name not in values for name in names):
            return _unknown(expression.span)
        return StructValue(type=wanted, span=expression.span, values=tuple(values[name] for name in names))


def element(operand: Expression, index: Expression, wanted: Type, span: Span) -> Expression:
    """The expression ``operand[index]``, or the element itself if it is known."""
    kind = operand.type.element if isinstance(operand.type, ArrayType) else wanted
    if isinstance(operand, ArrayElements) and isinstance(index, LiteralValue):
        position = index.value
        if isinstance(position, int) and 0 <= position < len(operand.values):
            return operand.values[position]
    return ElementValue(type=kind, span=span, operand=operand, index=index)


def _field(operand: Expression, name: str, span: Span) -> Expression:
    kind = operand.type.field(name) if isinstance(operand.type, StructType) else None
    return FieldValue(type=kind or UNKNOWN, span=span, operand=operand, field=name)


def _number(value: int | float, wanted: Type, span: Span) -> Expression:
    kind = wanted
    if isinstance(kind, RealType):
        return LiteralValue(type=kind, value=single(float(value)) if kind.bits == 32 else float(value), span=span)
    if not isinstance(kind, IntType | EnumType | TimeType):
        kind = IntType() if isinstance(value, int) else RealType()
    return LiteralValue(type=kind, value=value, span=span)


def _duration(expression: ast.Duration, wanted: Type) -> Expression:
    if not isinstance(wanted, RealType):
        return LiteralValue(type=TIME, value=expression.nanoseconds, span=expression.span)
    if expression.is_frequency:
        hertz = expression.magnitude * {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6}[expression.unit]
        return LiteralValue(type=wanted, value=hertz, span=expression.span)
    return LiteralValue(type=wanted, value=expression.nanoseconds / 1_000_000_000, span=expression.span)


def _array(values: tuple[Expression, ...], wanted: Type, span: Span) -> Expression:
    inner = values[0].type if values else wanted.element if isinstance(wanted, ArrayType) else UNKNOWN
    return ArrayElements(type=ArrayType(inner, len(values)), span=span, values=values)


def _unknown(span: Span) -> Expression:
    return LiteralValue(type=UNKNOWN, value=0, span=span)
