"""Values where a type is expected: literal numbers adapt, everything else must agree."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from cspdiag.base import Diagnostic, Span
from cspdiag.base.record import node
from cspdiag.model.diagnostics.types import ConstantNotTime, WrongType
from cspdiag.model.diagnostics.units import WrongScale, WrongUnit
from cspdiag.model.types import (
    DOUBLE,
    TIME,
    UNKNOWN,
    ArrayType,
    IntType,
    RealType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.model.units import DIMENSIONLESS, SECOND, agree, same_dimension
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.model.context import Context


@node
class Purpose:
    """What a value is used for, such as ``the parameter `speed```, and where that was declared."""

    what: str
    declared: Span | None = None
    declared_text: str = "declared here"


def is_bare_zero(expression: ast.Expression) -> bool:
    """Whether this is a ``0`` without a unit, which can take any unit."""
    return isinstance(expression, ast.Number) and expression.unit is None and expression.value == 0


def require(context: Context, expression: ast.Expression, found: Type, expected: Type, purpose: Purpose) -> Type:
    """The type of a value for a purpose: ``expected`` if it agrees or adapts; otherwise it is reported and unknown."""
    if adapt(context, expression, found, expected):
        return expected
    constant = _no_time(context, expression) if isinstance(expected, TimeType) else None
    if constant is not None:
        advice = f"const {constant.name.text} : time = {constant.value.span.text}`, which is its period"
        if isinstance(constant.value, ast.Number):
            advice = f"const {constant.name.text} = {constant.value.value!r} s`"
        refused = ConstantNotTime(
            constant.value.span, constant.name.text, found, purpose.what, expression.span, f"write `{advice}"
        )
        context.refuse(refused, expression)
        return UNKNOWN
    culprit = _mismatched_part(context, expression, expected)
    if culprit is not None:
        return require(context, culprit, context.program.types[culprit], _element(expected, expression), purpose)
    if isinstance(found, IntType) and isinstance(expected, RealType) and expression in context.literals:
        # A literal number would become a double here, so only the unit is wrong.
        retype(context, expression, expected)
        found = context.program.types[expression]
    context.refuse(_mismatch(expression, found, expected, purpose), expression)
    return UNKNOWN


def _no_time(context: Context, expression: ast.Expression) -> ast.Constant | None:
    """The constant without a type that an expression names, if its value was written as a frequency or as a number of
    seconds.
    """
    found = None
    while isinstance(expression, ast.Name):
        symbol = context.program.bindings.get(expression)
        if not isinstance(symbol, ast.Constant) or symbol.type is not None:
            return None
        found, expression = symbol, symbol.value
    is_frequency = isinstance(expression, ast.Duration) and expression.is_frequency
    is_seconds = isinstance(expression, ast.Number) and expression.unit == "s"
    return found if is_frequency or is_seconds else None


def _mismatch(expression: ast.Expression, found: Type, expected: Type, purpose: Purpose) -> Diagnostic:
    span, what, declared, text = expression.span, purpose.what, purpose.declared, purpose.declared_text
    if not isinstance(found, RealType) or not isinstance(expected, RealType) or agree(found.unit, expected.unit):
        return WrongType(span, what, found, expected, declared, text)
    if same_dimension(found.unit, expected.unit):
        return WrongScale(span, what, found, expected, declared, text)
    is_number = isinstance(expression, ast.Number) and expression.unit is None
    return WrongUnit(span, what, found, expected, declared, text, is_number)


def _mismatched_part(context: Context, expression: ast.Expression, expected: Type) -> ast.Expression | None:
    """The part of an array or a conditional expression that does not agree."""
    parts: tuple[ast.Expression, ...] = ()
    if isinstance(expression, ast.ArrayValue) and isinstance(expected, ArrayType):
        if expected.size is not None and expected.size != len(expression.elements):
            return None
        parts = expression.elements
    elif isinstance(expression, ast.Conditional):
        parts = (expression.then, expression.otherwise)
    for part in parts:
        if not adapt(context, part, context.program.types[part], _element(expected, expression)):
            return part
    return None


def _element(expected: Type, expression: ast.Expression) -> Type:
    if isinstance(expected, ArrayType) and isinstance(expression, ast.ArrayValue):
        return expected.element
    return expected


def adapt(context: Context, expression: ast.Expression, found: Type, expected: Type) -> bool:
    """Whether a value agrees with a type; literal numbers adapt to the type, which is recorded."""
    if isinstance(found, UnknownType) or isinstance(expected, UnknownType):
        return True
    if agrees(found, expected):
        return True
    match expression:
        case ast.Number() if is_bare_zero(expression) and isinstance(expected, RealType | TimeType):
            return _adapt_zero(context, expression, found, expected)
        case ast.Duration():
            return _adapt_duration(context, expression, found, expected)
        case ast.ArrayValue() if isinstance(expected, ArrayType):
            size = len(expression.elements)
            fits = expected.size in {None, size} and _adapt_all(context, expression.elements, expected.element)
            whole: Type = ArrayType(expected.element, size)
        case ast.Conditional():
            fits = _adapt_all(context, (expression.then, expression.otherwise), expected)
            whole = expected
        case (
            ast.Number() | ast.Boolean() | ast.Text() | ast.Name() | ast.Member() | ast.Index() | ast.Unary()
            | ast.Binary() | ast.Call() | ast.ArrayValue()
        ):  # fmt: skip
            fits = False
            whole = expected
        case _:
            assert_never(expression)
    if fits:
        context.program.types[expression] = whole
        return True
    if expression in context.literals and can_retype(found, expected):
        retype(context, expression, expected)
        return agrees(context.program.types[expression], expected)
    return False


def _adapt_all(context: Context, parts: tuple[ast.Expression, ...], expected: Type) -> bool:
    return all(adapt(context, part, context.program.types[part], expected) for part in parts)


def _adapt_zero(context: Context, zero: ast.Number, found: Type, expected: Type) -> bool:
    """``0`` takes any unit and is a time as well; ``0.0`` stays a real number."""
    if isinstance(found, IntType) or (isinstance(found, RealType) and isinstance(expected, RealType)):
        context.program.types[zero] = expected
        return True
    return False


def _adapt_duration(context: Context, duration: ast.Duration, found: Type, expected: Type) -> bool:
    """A frequency means its period where a time is expected; a duration means seconds where a number is expected."""
    if isinstance(expected, TimeType) and duration.is_frequency:
        context.program.types[duration] = TIME
        return True
    if isinstance(expected, RealType) and agree(expected.unit, SECOND) and not duration.is_frequency:
        context.program.types[duration] = RealType(expected.bits, SECOND)
        return True
    if isinstance(found, RealType) and isinstance(expected, RealType) and agree(found.unit, expected.unit):
        context.program.types[duration] = RealType(expected.bits, found.unit)
        return True
    return False


def agrees(found: Type, expected: Type) -> bool:
    """Whether a value of one type is a value of the other; ``rad`` counts as 1, unknown sizes agree with any size."""
    match found, expected:
        case (UnknownType(), _) | (_, UnknownType()):
            return True
        case RealType(), RealType():
            return found.bits == expected.bits and agree(found.unit, expected.unit)
        case ArrayType(), ArrayType():
            return (found.size is None or expected.size is None or found.size == expected.size) and agrees(
                found.element, expected.element
            )
        case _:  # Other pairs of types have no unit and no size.
            return found == expected


def same(found: Type, expected: Type) -> bool:
    """Whether two ends of a communication have the same type and unit; unknown sizes agree with any size."""
    match found, expected:
        case (UnknownType(), _) | (_, UnknownType()):
            return True
        case ArrayType(), ArrayType():
            sizes_agree = found.size is None or expected.size is None or found.size == expected.size
            return sizes_agree and same(found.element, expected.element)
        case _:  # Other pairs of types have no size.
            return found == expected


def can_retype(found: Type, expected: Type) -> bool:
    """Whether an expression of literal numbers may become a different number type."""
    if isinstance(found, IntType):
        return isinstance(expected, IntType | RealType)
    return isinstance(found, RealType) and isinstance(expected, RealType)


def retype(context: Context, expression: ast.Expression, expected: Type) -> None:
    """Give an expression of literal numbers, with its parts, the number type of ``expected``; units do not change."""
    types = context.program.types
    pending: list[ast.Expression] = [expression]
    while pending:
        part = pending.pop()
        found = types[part]
        if isinstance(expected, RealType):
            types[part] = RealType(expected.bits, found.unit if isinstance(found, RealType) else DIMENSIONLESS)
        else:
            types[part] = expected
        match part:
            case ast.Unary():
                pending.append(part.operand)
            case ast.Binary():
                pending += (part.left, part.right)
            case ast.Conditional():
                pending += (part.then, part.otherwise)
            case (
                ast.Number() | ast.Duration() | ast.Boolean() | ast.Text() | ast.Name() | ast.Member() | ast.Index()
                | ast.Call() | ast.ArrayValue()
            ):  # fmt: skip
                pass
            case _:
                assert_never(part)


def default_number(context: Context, expression: ast.Expression, found: Type) -> Type:
    """The type of an operand of a real function: integer literals become doubles."""
    if isinstance(found, IntType) and expression in context.literals:
        retype(context, expression, DOUBLE)
        return DOUBLE
    return found
