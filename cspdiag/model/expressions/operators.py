"""Types of unary and binary operators and of conditional expressions (section 3 of the language)."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from cspdiag.model.diagnostics.types import DifferentTypes, MixedNumbers, NotCondition, UnsuitableOperand
from cspdiag.model.diagnostics.units import MixedUnits, NotDimensionless, PowerWithoutUnit
from cspdiag.model.expressions.coercion import adapt, agrees, is_bare_zero
from cspdiag.model.types import (
    BOOL,
    INT,
    TIME,
    UNKNOWN,
    ArrayType,
    BoolType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TextType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.model.units import SECOND, agree, divide, multiply, power
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.model.context import Context

_ARITHMETIC = frozenset("+-*/%^")


def unary(context: Context, expression: ast.Unary, operand: Type) -> Type:
    """The type of ``-x`` or ``not x``."""
    if isinstance(operand, UnknownType):
        return BOOL if expression.operator == "not" else UNKNOWN
    if expression.operator == "not":
        if not isinstance(operand, BoolType):
            context.refuse(NotCondition(expression.operand.span, found=operand), expression)
        return BOOL
    if not isinstance(operand, IntType | RealType | TimeType):
        advice = "write `not`" if isinstance(operand, BoolType) else None
        context.refuse(UnsuitableOperand(expression.span, operator="-", found=operand, advice=advice), expression)
        return UNKNOWN
    if expression.operand in context.literals:
        context.literals.add(expression)
    return operand


def binary(context: Context, expression: ast.Binary, left: Type, right: Type) -> Type:
    """The type of a binary operation; a literal number takes the type of the other side."""
    operator = expression.operator
    if operator in _ARITHMETIC and expression.left in context.literals and expression.right in context.literals:
        context.literals.add(expression)
    match operator:
        case "and" | "or":
            for side, found in ((expression.left, left), (expression.right, right)):
                if not isinstance(found, BoolType | UnknownType):
                    context.refuse(NotCondition(side.span, found=found), expression)
            return BOOL
        case "==" | "!=" | "<" | "<=" | ">" | ">=":
            if not (isinstance(left, UnknownType) or isinstance(right, UnknownType)):
                _compare(context, expression, *peers(context, expression.left, left, expression.right, right))
            return BOOL
        case "+" | "-" | "*" | "/" | "%" | "^":
            if isinstance(left, UnknownType) or isinstance(right, UnknownType):
                return _guess(context, operator, left, right)
            return _arithmetic(context, expression, left, right)
        case _:
            assert_never(operator)


def _guess(context: Context, operator: str, left: Type, right: Type) -> Type:
    """The type of an operation while types are found by trial: a sum has the type of the operand that is known."""
    if context.guessing and operator in "+-":
        return right if isinstance(left, UnknownType) else left
    return UNKNOWN


def peers(
    context: Context, left: ast.Expression, left_type: Type, right: ast.Expression, right_type: Type
) -> tuple[Type, Type]:
    """The types of two operands that must agree, after literal numbers have taken the type of the other side."""
    types = context.program.types
    if agrees(left_type, right_type):
        return left_type, right_type
    # An operand of literal numbers without a unit stays without one, except for a bare zero.
    if _adapts(context, left, left_type, right_type):
        return types[left], right_type
    if _adapts(context, right, right_type, left_type):
        return left_type, types[right]
    return left_type, right_type


def _adapts(context: Context, expression: ast.Expression, found: Type, other: Type) -> bool:
    if isinstance(other, RealType) and expression in context.literals and not is_bare_zero(expression):
        if isinstance(found, IntType) or (isinstance(found, RealType) and found.bits != other.bits):
            unitless = RealType(other.bits, found.unit) if isinstance(found, RealType) else RealType(other.bits)
            return adapt(context, expression, found, unitless)
        return False
    return adapt(context, expression, found, other)


def _arithmetic(context: Context, expression: ast.Binary, left: Type, right: Type) -> Type:
    operator = expression.operator
    for side, found in ((expression.left, left), (expression.right, right)):
        if not isinstance(found, IntType | RealType | TimeType):
            context.refuse(UnsuitableOperand(side.span, operator=operator, found=found, advice=None), expression)
            return UNKNOWN
    if isinstance(left, TimeType) or isinstance(right, TimeType):
        result = _time_arithmetic(context, expression, left, right)
        if result is not None:
            return result
    # A product has a unit of its own, so a zero next to `*` stays a number.
    if operator in "+-":
        left, right = peers(context, expression.left, left, expression.right, right)
    else:
        left, right = _number_peers(context, expression, left, right)
    match left, right:
        case IntType(), IntType() if left == right:
            return left
        case RealType(), RealType() if left.bits == right.bits:
            return _real_arithmetic(context, expression, left, right)
        case _:  # Other pairs of types cannot be combined.
            _refuse_mixture(context, expression, left, right)
            return UNKNOWN


def _number_peers(context: Context, expression: ast.Binary, left: Type, right: Type) -> tuple[Type, Type]:
    if isinstance(left, RealType) and isinstance(right, RealType) and left.bits == right.bits:
        return left, right
    types = context.program.types
    for side, found, other in ((expression.left, left, right), (expression.right, right, left)):
        if side not in context.literals:
            continue
        if isinstance(other, RealType):
            expected: Type = RealType(other.bits, found.unit) if isinstance(found, RealType) else RealType(other.bits)
        else:
            expected = other
        if adapt(context, side, found, expected):
            break
    return types.get(expression.left, left), types.get(expression.right, right)


def _time_arithmetic(context: Context, expression: ast.Binary, left: Type, right: Type) -> Type | None:
    """The type of arithmetic on durations, which are added, and multiplied and divided by integers; None for others."""
    types = context.program.types
    match expression.operator, left, right:
        case "+" | "-" | "%", _, _:
            left, right = peers(context, expression.left, left, expression.right, right)
            return TIME if isinstance(left, TimeType) and isinstance(right, TimeType) else None
        case "*", TimeType(), IntType(bits=64) | UnknownType():
            return TIME
        case "*", IntType(bits=64), TimeType():
            return TIME
        case "/", TimeType(), IntType(bits=64):
            return TIME
        case "/", TimeType(), TimeType():
            return INT
        case "*" | "/", TimeType(), RealType() if isinstance(expression.left, ast.Duration):
            # A literal duration next to a double is a number of seconds.
            if adapt(context, expression.left, left, _seconds(right)):
                return _real_arithmetic(context, expression, types[expression.left], right)
            return None
        case "*" | "/", RealType(), TimeType() if isinstance(expression.right, ast.Duration):
            if adapt(context, expression.right, right, _seconds(left)):
                return _real_arithmetic(context, expression, left, types[expression.right])
            return None
        case _:  # Other operations have no durations.
            return None


def _seconds(other: RealType) -> Type:
    return RealType(other.bits, SECOND)


def _real_arithmetic(context: Context, expression: ast.Binary, left: Type, right: Type) -> Type:
    assert isinstance(left, RealType)
    assert isinstance(right, RealType)
    match expression.operator:
        case "+" | "-":
            if not agree(left.unit, right.unit):
                _refuse_mixture(context, expression, left, right)
                return UNKNOWN
            return left if left.unit.text or not right.unit.text else right
        case "*":
            return RealType(left.bits, multiply(left.unit, right.unit))
        case "/":
            return RealType(left.bits, divide(left.unit, right.unit))
        case "^":
            return _power(context, expression, left, right)
        case "%" | "==" | "!=" | "<" | "<=" | ">" | ">=" | "and" | "or":
            advice = "`%` is the remainder of integers and times"
            operator = expression.operator
            refused = UnsuitableOperand(expression.span, operator=operator, found=left, advice=advice)
            context.refuse(refused, expression)
            return UNKNOWN
        case _:
            assert_never(expression.operator)


def _power(context: Context, expression: ast.Binary, base: RealType, exponent: RealType) -> Type:
    if not agree(exponent.unit, RealType().unit):
        context.refuse(NotDimensionless(expression.right.span, what="an exponent", found=exponent), expression)
        return UNKNOWN
    if agree(base.unit, RealType().unit):
        return RealType(base.bits)
    number = _written_number(expression.right)
    doubled = number * 2 if number is not None else 0.5
    unit = power(base.unit, int(doubled), 2) if doubled == int(doubled) else None
    if unit is None:
        operation = f"the power `{expression.right.span.text}`"
        context.refuse(PowerWithoutUnit(expression.span, found=base, operation=operation), expression)
        return UNKNOWN
    return RealType(base.bits, unit)


def _written_number(expression: ast.Expression) -> float | None:
    if isinstance(expression, ast.Unary) and expression.operator == "-":
        value = _written_number(expression.operand)
        return None if value is None else -value
    if isinstance(expression, ast.Number) and expression.unit is None and abs(expression.value) < 1000:
        return float(expression.value)
    return None


def _refuse_mixture(context: Context, expression: ast.Binary, left: Type, right: Type) -> None:
    spans = {"left_span": expression.left.span, "right_span": expression.right.span}
    if isinstance(left, RealType) and isinstance(right, RealType) and left.bits == right.bits:
        number = None
        for side, found in ((expression.left, left), (expression.right, right)):
            if isinstance(side, ast.Number) and side.unit is None and found.unit.is_dimensionless:
                number = side.span
        context.refuse(
            MixedUnits(expression.span, operator=expression.operator, left=left, right=right, number=number, **spans),
            expression,
        )
    else:
        context.refuse(
            MixedNumbers(expression.span, operator=expression.operator, left=left, right=right, **spans), expression
        )


def _compare(context: Context, expression: ast.Binary, left: Type, right: Type) -> None:
    ordered = expression.operator not in {"==", "!="}
    for side, found in ((expression.left, left), (expression.right, right)):
        if isinstance(found, TextType) or (ordered and isinstance(found, BoolType | EnumType | StructType | ArrayType)):
            refused = UnsuitableOperand(side.span, operator=expression.operator, found=found, advice=None)
            context.refuse(refused, expression)
            return
    if not agrees(left, right):
        _refuse_mixture(context, expression, left, right)


def unified(context: Context, parts: list[ast.Expression], types: list[Type], what: str, whole: ast.Expression) -> Type:
    """The common type of several values, such as the two sides of a conditional expression; literal numbers adapt.

    A part that does not agree is reported, and the type of the whole expression is unknown.
    """
    # The first part that does not consist of literal numbers determines the type, if numbers can take it.
    leader = next(
        (
            position
            for position, part in enumerate(parts)
            if part not in context.literals
            and isinstance(types[position], IntType | RealType | TimeType | ArrayType)
            and not isinstance(part, ast.Duration)
        ),
        0,
    )
    result = types[leader]
    for position, part in enumerate(parts):
        if position == leader or isinstance(types[position], UnknownType):
            continue
        if isinstance(result, UnknownType):
            result, leader = types[position], position
            continue
        first, second = peers(context, parts[leader], result, part, types[position])
        if not agrees(first, second):
            refused = DifferentTypes(part.span, what=what, first=first, second=second, first_span=parts[leader].span)
            context.refuse(refused, whole)
            return UNKNOWN
        if first != result:
            # The leader was a literal number, which has taken the type of this part.
            result, leader = first, position
        if isinstance(result, RealType) and isinstance(second, RealType) and not result.unit.text:
            result = second
    if _is_open(context, parts, types):
        return UNKNOWN
    for part in parts:
        adapt(context, part, context.program.types[part], result)
    return result


def _is_open(context: Context, parts: list[ast.Expression], types: list[Type]) -> bool:
    """Whether numbers would take the type of a part that has a mistake, so that the common type cannot be known."""
    if context.guessing or not any(isinstance(found, UnknownType) for found in types):
        return False
    known = (part for part, found in zip(parts, types, strict=True) if not isinstance(found, UnknownType))
    return all(part in context.literals or isinstance(part, ast.Duration) for part in known)
