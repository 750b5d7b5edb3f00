"""Evaluation of expressions that are known before the program runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import assert_never

from cspdiag.base import Report
from cspdiag.model.constants import arithmetic
from cspdiag.model.constants.arithmetic import OutOfRangeError, UndefinedError
from cspdiag.model.constants.values import parse_value
from cspdiag.model.diagnostics.constants import ConstantDivision, ConstantOverflow, IndexOutOfRange, NumberTooLarge
from cspdiag.model.program import BuiltinSymbol, EndLabelSymbol, EnumLiteralSymbol, PortSymbol, Program, Value
from cspdiag.model.symbols import CONVERSIONS
from cspdiag.model.types import (
    INT,
    IntType,
    RealType,
    StructType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.model.units import conversion_factor
from cspdiag.syntax import ast

__all__ = ["evaluate", "parse_value"]

_HERTZ = {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6}


def evaluate(
    program: Program, expression: ast.Expression, values: Mapping[ast.Node, Value], report: Report
) -> Value | None:
    """The value of a typed expression, given those of parameters and replicators (``ast.Parameter``,
    ``ast.Replicator``), and of parameters of the program (``ast.Constant``) where these may be used.

    None if part of it is unknown or has a mistake that was reported; overflow, division by zero and indexes out of
    range are reported here. A ``time`` is in nanoseconds unless the type of the expression is a number of seconds.
    """
    return _Evaluator(program, values, report).value(expression)


class _Evaluator:
    def __init__(self, program: Program, values: Mapping[ast.Node, Value], report: Report) -> None:
        self.program = program
        self.values = values
        self.report = report

    def type_of(self, expression: ast.Expression) -> Type:
        found = self.program.types.get(expression)
        return UnknownType() if found is None else found

    def value(self, expression: ast.Expression) -> Value | None:
        # Chains of operators are nested to the left and may be long, so they are evaluated without recursion.
        chain: list[ast.Binary] = []
        while isinstance(expression, ast.Binary):
            chain.append(expression)
            expression = expression.left
        found = self._value(expression)
        for operation in reversed(chain):
            found = self._binary(operation, found)
        return found

    def _value(self, expression: ast.Expression) -> Value | None:
        if expression in self.program.poisoned:
            return None
        match expression:
            case ast.Number():
                return self._number(expression)
            case ast.Duration():
                if isinstance(self.type_of(expression), TimeType):
                    return expression.nanoseconds
                if expression.is_frequency:
                    return expression.magnitude * _HERTZ[expression.unit]
                return expression.nanoseconds / 1e9
            case ast.Boolean() | ast.Text():
                return expression.value
            case ast.Name():
                return self._in_seconds(expression, self._name(expression))
            case ast.Member():
                return self._in_seconds(expression, self._member(expression))
            case ast.Index():
                return self._in_seconds(expression, self._index(expression))
            case ast.Unary():
                return self._unary(expression)
            case ast.Conditional():
                condition = self.value(expression.condition)
                if condition is None:
                    return None
                return self.value(expression.then if condition else expression.otherwise)
            case ast.Call():
                return self._call(expression)
            case ast.ArrayValue():
                return _all([self.value(element) for element in expression.elements])
            case ast.Binary():
                return self.value(expression)
            case _:
                assert_never(expression)

    def _in_seconds(self, expression: ast.Expression, value: Value | None) -> Value | None:
        """The value of a ``time``: in nanoseconds if it is stored as a time, in seconds if it is a double."""
        is_stored_time = isinstance(value, int) and not isinstance(value, bool)
        return value / 1e9 if is_stored_time and isinstance(self.type_of(expression), RealType) else value  # type: ignore[operator]

    def _number(self, expression: ast.Number, sign: int = 1) -> Value | None:
        """A literal with its sign, because the most negative integer has no positive counterpart."""
        type_ = self.type_of(expression)
        if isinstance(type_, UnknownType):
            return None
        try:
            return arithmetic.checked(sign * expression.value, type_)
        except (OutOfRangeError, UndefinedError, OverflowError):
            self.report.add(NumberTooLarge(expression.span, type=type_))
            return None

    def _checked(self, expression: ast.Expression, compute: Callable[[Type], Value | None]) -> Value | None:
        """The result of ``compute`` for the type of the expression; its errors are reported at the expression."""
        type_ = self.type_of(expression)
        if isinstance(type_, UnknownType):
            return None
        try:
            return compute(type_)
        except UndefinedError as problem:
            self.report.add(ConstantDivision(expression.span, problem=str(problem)))
            return None
        except OutOfRangeError as problem:
            self.report.add(ConstantOverflow(expression.span, value=problem.shown, type=type_))
            return None

    def _name(self, expression: ast.Name) -> Value | None:
        symbol = self.program.bindings.get(expression)
        match symbol:
            case ast.Constant():
                return self.program.constants.get(symbol, self.values.get(symbol))
            case ast.Parameter() | ast.Replicator():
                return self.values.get(symbol)
            case BuiltinSymbol(name="pi"):
                return math.pi
            case (
                ast.TypeAliasDefinition() | ast.EnumDefinition() | ast.StructDefinition() | ast.ExceptionDefinition()
                | ast.ProcessDefinition() | ast.SubmodelDefinition() | ast.DriverDefinition()
                | ast.EnvironmentDefinition() | ast.Variable() | ast.Channel() | ast.Instance() | ast.Let()
                | ast.State() | PortSymbol() | EndLabelSymbol() | EnumLiteralSymbol() | BuiltinSymbol() | None
            ):  # fmt: skip
                return None
            case _:
                assert_never(symbol)

    def _member(self, expression: ast.Member) -> Value | None:
        member = self.program.members.get(expression)
        if isinstance(member, EnumLiteralSymbol):
            return member.index
        owner = self.type_of(expression.value)
        if not isinstance(member, str) or not isinstance(owner, StructType):
            return None
        whole = self.value(expression.value)
        names = [name for name, _ in owner.fields]
        return whole[names.index(member)] if isinstance(whole, tuple) else None

    def _index(self, expression: ast.Index) -> Value | None:
        whole, index = self.value(expression.value), self.value(expression.index)
        if not isinstance(whole, tuple) or not isinstance(index, int):
            return None
        if not 0 <= index < len(whole):
            self.report.add(IndexOutOfRange(expression.index.span, index=index, size=len(whole)))
            return None
        return whole[index]

    def _unary(self, expression: ast.Unary) -> Value | None:
        operand = expression.operand
        if expression.operator == "-" and isinstance(operand, ast.Number):
            return self._number(operand, -1)
        value = self.value(operand)
        if isinstance(operand, ast.Duration) and isinstance(value, int) and value > INT.maximum + 1:
            # A duration that is too long has already been reported.
            return None
        if expression.operator == "not":
            return None if value is None else not value
        if not isinstance(value, int | float):
            return None
        return self._checked(expression, lambda type_: arithmetic.checked(-value, type_))

    def _binary(self, expression: ast.Binary, left: Value | None) -> Value | None:
        operator = expression.operator
        if (operator == "and" and left is False) or (operator == "or" and left is True):
            return left
        right = self.value(expression.right)
        if operator in {"/", "%"} and right == 0 and left is None and isinstance(right, int | float):
            left = 1 if isinstance(right, int) else 1.0
        if left is None or right is None or expression in self.program.poisoned:
            return None
        match operator:
            case "and" | "or":
                return right
            case "==":
                return left == right
            case "!=":
                return left != right
            case "<" | "<=" | ">" | ">=":
                return _ordered(operator, left, right)
            case "+" | "-" | "*" | "/" | "%" | "^":
                if not isinstance(left, int | float) or not isinstance(right, int | float):
                    return None
                return self._checked(expression, lambda type_: arithmetic.operate(operator, left, right, type_))
            case _:
                assert_never(operator)

    def _call(self, expression: ast.Call) -> Value | None:
        symbol = self.program.bindings.get(expression.function)
        if isinstance(symbol, ast.StructDefinition):
            return self._structure(expression, symbol)
        name = expression.function.text
        if not isinstance(symbol, BuiltinSymbol):
            return None
        if name == "convert":
            return self._convert(expression)
        found = _all([self.value(argument.value) for argument in expression.arguments])
        if found is None or not all(isinstance(value, int | float) for value in found):
            return None
        numbers = [value for value in found if isinstance(value, int | float)]
        if name in CONVERSIONS:
            return self._conversion(expression, numbers[0])
        return self._checked(expression, lambda type_: arithmetic.function(name, numbers, type_))

    def _conversion(self, expression: ast.Call, value: int | float) -> Value | None:
        if isinstance(self.type_of(expression.arguments[0].value), TimeType):
            return value / 1e9

        def compute(type_: Type) -> Value | None:
            return arithmetic.convert(value, type_) if isinstance(type_, IntType | RealType) else None

        return self._checked(expression, compute)

    def _convert(self, expression: ast.Call) -> Value | None:
        operand = expression.arguments[0].value
        value, found = self.value(operand), self.type_of(operand)
        if not isinstance(value, float) or not isinstance(found, RealType):
            return None

        def compute(type_: Type) -> Value | None:
            factor = conversion_factor(found.unit, type_.unit) if isinstance(type_, RealType) else None
            return None if factor is None else arithmetic.checked(value * factor, type_)

        return self._checked(expression, compute)

    def _structure(self, expression: ast.Call, definition: ast.StructDefinition) -> Value | None:
        given: dict[str, Value | None] = {}
        for field, argument in zip(definition.fields, expression.arguments, strict=False):
            given[argument.name.text if argument.name else field.name.text] = self.value(argument.value)
        return _all([given.get(field.name.text) for field in definition.fields])


def _ordered(operator: str, left: Value, right: Value) -> bool | None:
    if not isinstance(left, int | float) or not isinstance(right, int | float):
        return None
    match operator:
        case "<":
            return left < right
        case "<=":
            return left <= right
        case ">":
            return left > right
        case ">=":
            return left >= right
        case _:
            raise AssertionError(f"`{operator}` orders nothing")


def _all(values: list[Value | None]) -> tuple[Value, ...] | None:
    known = tuple(value for value in values if value is not None)
    return known if len(known) == len(values) else None
