"""Shorthands for expressions of real numbers that the compiler makes."""

from __future__ import annotations

from typing import Literal

from cspdiag.model.types import INT, RealType, Type
from cspdiag.network.ir.expressions import (
    BinaryOperation,
    Conversion,
    ElementValue,
    Expression,
    Function,
    FunctionCall,
    LiteralValue,
)

Operator = Literal["+", "-", "*", "/"]


def number(value: float, kind: Type) -> Expression:
    """A literal real number."""
    return LiteralValue(type=kind, value=value)


def operation(operator: Operator, left: Expression, right: Expression, kind: Type | None = None) -> Expression:
    """The operation ``left operator right``, by default of the type of ``left``."""
    return BinaryOperation(type=kind or left.type, operator=operator, left=left, right=right)


def plus(left: Expression, right: Expression) -> Expression:
    """The sum."""
    return operation("+", left, right)


def minus(left: Expression, right: Expression) -> Expression:
    """The difference."""
    return operation("-", left, right)


def times(left: Expression, right: Expression) -> Expression:
    """The product, of the type of the right factor."""
    return operation("*", left, right, right.type)


def over(left: Expression, right: Expression) -> Expression:
    """The quotient."""
    return operation("/", left, right)


def call(function: Function, *arguments: Expression) -> Expression:
    """A call of a function of the language, of the type of its first argument."""
    return FunctionCall(type=arguments[0].type, function=function, arguments=arguments)


def of_width(value: Expression, kind: Type) -> Expression:
    """``value`` converted to the width of ``kind``, since operands must have the same width."""
    if isinstance(kind, RealType) and isinstance(value.type, RealType) and kind.bits != value.type.bits:
        return Conversion(type=RealType(kind.bits, value.type.unit), operand=value)
    return value


def entry(array: Expression, *indexes: int) -> Expression:
    """The element of an array at known indexes."""
    for index in indexes:
        kind = getattr(array.type, "element", array.type)
        array = ElementValue(type=kind, operand=array, index=LiteralValue(type=INT, value=index))
    return array
