"""Values where a type is wanted: numbers in the text adapt, everything else must agree."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from cspdiag.base import Diagnostic, Span
from cspdiag.base.record import node
from cspdiag.model.diagnostics.types import ConstantNoTime, WrongType
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
    """What a value is for: ``the parameter `speed```, and where that was declared."""

    what: str
    declared: Span | None = None
    declared_text: str = "declared here"


def is_bare_zero(expression: ast.Expression) -> bool:
    """Whether this is a ``0`` without a unit, which takes any."""
    return isinstance(expression, ast.Number) and expression.unit is None and expression.value == 0


def require(context: Context, expression: ast.Expression, found: Type, wanted: Type, purpose: Purpose) -> Type:
    """The type of a value for a purpose: ``wanted`` if it agrees or adapts, else reported and unknown."""
    if adapt(context, expression, found, wanted):
        return wanted
    constant = _no_time(context, expression) if isinstance(wanted, TimeType) else None
    if constant is not None:
        advice = f"const {constant.name.text} : time = {constant.value.span.text}`, which is its period"
        if isinstance(constant.value, ast.Number):
            advice = f"const {constant.name.text} = {constant.value.value!r} s`"
        refused = ConstantNoTime(
            constant.value.span, constant.name.text, found, purpose.what, expression.span, f"write `{advice}"
        )
        context.refuse(refused, expression)
        return UNKNOWN
    culprit = _culprit(context, expression, wanted)
    if culprit is not None:
        return require(context, culprit, context.program.types[culprit], _element(wanted, expression), purpose)
    if isinstance(found, IntType) and isinstance(wanted, RealType) and expression in context.literals:
        # A number in the text becomes a double where one is wanted: what it lacks is the unit.
        retype(context, expression, wanted)
        found = context.program.types[expression]
    context.refuse(_mismatch(expression, found, wanted, purpose), expression)
    return UNKNOWN


def _no_time(context: Context, expression: ast.Expression) -> ast.Constant | None:
    """The constant without a type that an expression names, if a frequency or a number of seconds was written as its
    value.
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


def _mismatch(expression: ast.Expression, found: Type, wanted: Type, purpose: Purpose) -> Diagnostic:
    span, what, declared, text = expression.span, purpose.what, purpose.declared, purpose.declared_text
    if not isinstance(found, RealType) or not isinstance(wanted, RealType) or agree(found.unit, wanted.unit):
        return WrongType(span, what, found, wanted, declared, text)
    if same_dimension(found.unit, wanted.unit):
        return WrongScale(span, what, found, wanted, declared, text)
    is_number = isinstance(expression, ast.Number) and expression.unit is None
    return WrongUnit(span, what, found, wanted, is_number, declared, text)


def _culprit(context: Context, expression: ast.Expression, wanted: Type) -> ast.Expression | None:
    """The part of an array or a choice that does not fit."""
    parts: tuple[ast.Expression, ...] = ()
    if isinstance(expression, ast.ArrayValue) and isinstance(wanted, ArrayType):
        if wanted.size is not None and wanted.size != len(expression.elements):
            return None
        parts = expression.elements
    elif isinstance(expression, ast.Conditional):
        parts = (expression.then, expression.otherwise)
    for part in parts:
        if not adapt(context, part, context.program.types[part], _element(wanted, expression)):
            return part
    return None


def _element(wanted: Type, expression: ast.Expression) -> Type:
    if isinstance(wanted, ArrayType) and isinstance(expression, ast.ArrayValue):
        return wanted.element
    return wanted


def adapt(context: Context, expression: ast.Expression, found: Type, wanted: Type) -> bool:
    """Whether a value agrees with a type; numbers in the text take it on, and that is recorded."""
    if isinstance(found, UnknownType) or isinstance(wanted, UnknownType):
        return True
    if agrees(found, wanted):
        return True
    match expression:
        case ast.Number() if is_bare_zero(expression) and isinstance(wanted, RealType | TimeType):
            return _adapt_zero(context, expression, found, wanted)
        case ast.Duration():
            return _adapt_duration(context, expression, found, wanted)
        case ast.ArrayValue() if isinstance(wanted, ArrayType):
            size = len(expression.elements)
            fits = wanted.size in {None, size} and _adapt_all(context, expression.elements, wanted.element)
            whole: Type = ArrayType(wanted.element, size)
        case ast.Conditional():
            fits = _adapt_all(context, (expression.then, expression.otherwise), wanted)
            whole = wanted
        case (
            ast.Number() | ast.Boolean() | ast.Text() | ast.Name() | ast.Member() | ast.Index() | ast.Unary()
            | ast.Binary() | ast.Call() | ast.ArrayValue()
        ):  # fmt: skip
            fits = False
            whole = wanted
        case _:
            assert_never(expression)
    if fits:
        context.program.types[expression] = whole
        return True
    if expression in context.literals and can_retype(found, wanted):
        retype(context, expression, wanted)
        return agrees(context.program.types[expression], wanted)
    return False


def _adapt_all(context: Context, parts: tuple[ast.Expression, ...], wanted: Type) -> bool:
    return all(adapt(context, part, context.program.types[part], wanted) for part in parts)


def _adapt_zero(context: Context, zero: ast.Number, found: Type, wanted: Type) -> bool:
    """``0`` takes any unit and is a time as well; ``0.0`` stays a real number."""
    if isinstance(found, IntType) or (isinstance(found, RealType) and isinstance(wanted, RealType)):
        context.program.types[zero] = wanted
        return True
    return False


def _adapt_duration(context: Context, duration: ast.Duration, found: Type, wanted: Type) -> bool:
    """A frequency means its period where a time is wanted, a duration its seconds where those are."""
    if isinstance(wanted, TimeType) and duration.is_frequency:
        context.program.types[duration] = TIME
        return True
    if isinstance(wanted, RealType) and agree(wanted.unit, SECOND) and not duration.is_frequency:
        context.program.types[duration] = RealType(wanted.bits, SECOND)
        return True
    if isinstance(found, RealType) and isinstance(wanted, RealType) and agree(found.unit, wanted.unit):
        context.program.types[duration] = RealType(wanted.bits, found.unit)
        return True
    return False


def agrees(found: Type, wanted: Type) -> bool:
    """Whether a value of one type is one of the other; ``rad`` counts as 1, unknown sizes agree with any."""
    match found, wanted:
        case (UnknownType(), _) | (_, UnknownType()):
            return True
        case RealType(), RealType():
            return found.bits == wanted.bits and agree(found.unit, wanted.unit)
        case ArrayType(), ArrayType():
            return (found.size is None or wanted.size is None or found.size == wanted.size) and agrees(
                found.element, wanted.element
            )
        case _:  # Other pairs of types have no unit and no size.
            return found == wanted


def same(found: Type, wanted: Type) -> bool:
    """Whether two ends of a communication have the same type and unit; unknown sizes agree with any."""
    match found, wanted:
        case (UnknownType(), _) | (_, UnknownType()):
            return True
        case ArrayType(), ArrayType():
            sizes_agree = found.size is None or wanted.size is None or found.size == wanted.size
            return sizes_agree and same(found.element, wanted.element)
        case _:  # Other pairs of types have no size.
            return found == wanted


def can_retype(found: Type, wanted: Type) -> bool:
    """Whether an expression of numbers in the text may become another number type."""
    if isinstance(found, IntType):
        return isinstance(wanted, IntType | RealType)
    return isinstance(found, RealType) and isinstance(wanted, RealType)


def retype(context: Context, expression: ast.Expression, wanted: Type) -> None:
    """Give an expression of numbers in the text the number type of ``wanted``, all parts of it; units stay
    as written.
    """
    types = context.program.types
    pending: list[ast.Expression] = [expression]
    while pending:
        part = pending.pop()
        found = types[part]
        if isinstance(wanted, RealType):
            types[part] = RealType(wanted.bits, found.unit if isinstance(found, RealType) else DIMENSIONLESS)
        else:
            types[part] = wanted
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
    """The type of an operand of a real function: numbers without a point become doubles."""
    if isinstance(found, IntType) and expression in context.literals:
        retype(context, expression, DOUBLE)
        return DOUBLE
    return found
