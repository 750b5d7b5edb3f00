"""Adds tests of real values: a value that is stored or written is finite, otherwise it is a fault.

Within an expression, and from one equation of a law to the next, sums, products and quotients are computed with
infinities and NaNs as in IEEE 754. Functions outside their domain fault at once; so does a division by zero, without a
test.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import assert_never

from cspdiag.base.record import replaced
from cspdiag.model.types import INT, ArrayType, RealType, StructType, has_real
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expression_walk import operands, walk
from cspdiag.network.ir.expressions import (
    ArrayElements,
    BinaryOperation,
    ConditionalValue,
    Conversion,
    ElementValue,
    Expression,
    FieldValue,
    FunctionCall,
    LiteralValue,
    ParameterValue,
    PresentTime,
    SignalValue,
    StructValue,
    TunableValue,
    UnaryOperation,
    VariableValue,
)

_HAS_DOMAIN = frozenset({"sqrt", "exp", "log", "asin", "acos"})
_NONE: frozenset[str] = frozenset()


def assured(expression: Expression) -> Expression:
    """An expression whose value is stored or written, with its tests."""
    return stored(within_domains(expression))


def stored(expression: Expression) -> Expression:
    """An expression that is stored or written, with tests of its value; tests that it has stay as they are."""
    return _stored(expression, _NONE)


def assured_law(
    equations: Sequence[SubmodelEquation | ExternalCall],
    next_values: Mapping[str, Expression],
    outputs: Iterable[str],
    unsure: Iterable[str] = (),
) -> tuple[tuple[SubmodelEquation | ExternalCall, ...], dict[str, Expression]]:
    """The equations of a law, in the order of their evaluation, and the next values of its states, with their tests.

    Outputs, states, and inputs of code in other languages are tested, local values and what that code returns only as
    parts of these. ``unsure`` are signals from elsewhere that may be infinite or NaN.
    """
    results = frozenset(outputs)
    untested: set[str] = set(unsure)
    made: list[SubmodelEquation | ExternalCall] = []
    for item in equations:
        if isinstance(item, ExternalCall):
            given = tuple((port, _stored(within_domains(value), untested)) for port, value in item.inputs)
            made.append(replaced(item, inputs=given))
            untested.update(name for _, name, kind in item.outputs if has_real(kind))
            continue
        value = within_domains(item.value)
        if item.name in results:
            value = _stored(value, untested)
        elif _may_be_none(value, untested):
            untested.add(item.name)
        made.append(item if value is item.value else replaced(item, value=value))
    return tuple(made), {name: _stored(within_domains(value), untested) for name, value in next_values.items()}


def within_domains(expression: Expression) -> Expression:
    """The expression with tests of functions that are not defined everywhere."""
    if is_defined_everywhere(expression):
        return expression
    return rewritten(expression, lambda part: _tested(part) if _has_domain(part) else part)


def is_defined_everywhere(expression: Expression) -> bool:
    """Whether no function in the expression has a domain."""
    return not any(map(_has_domain, walk(expression)))


def _has_domain(expression: Expression) -> bool:
    match expression:
        case BinaryOperation(operator="^"):
            return isinstance(expression.type, RealType)
        case FunctionCall(function="quantize", arguments=(_, step)):
            return not (isinstance(step, LiteralValue) and step.value != 0)
        case FunctionCall(function=function):
            return function in _HAS_DOMAIN
        case (
            LiteralValue() | ParameterValue() | TunableValue() | VariableValue() | SignalValue() | PresentTime()
            | UnaryOperation() | BinaryOperation() | ConditionalValue() | Conversion() | FieldValue() | ElementValue()
            | StructValue() | ArrayElements()
        ):  # fmt: skip
            return False
        case _:
            assert_never(expression)


def _tested(expression: Expression) -> Expression:
    return FunctionCall(type=expression.type, span=expression.span, function="finite", arguments=(expression,))


def _stored(expression: Expression, untested: set[str] | frozenset[str]) -> Expression:
    """The expression with a test of its value, or of its elements or fields."""
    match expression:
        case StructValue(values=values) | ArrayElements(values=values):
            return replaced(expression, values=tuple(_stored(value, untested) for value in values))
        case SignalValue(name=name) if name in untested and not isinstance(expression.type, RealType):
            return _tested_parts(expression)
        case ConditionalValue(then=then, otherwise=otherwise) if not isinstance(expression.type, RealType):
            return replaced(expression, then=_stored(then, untested), otherwise=_stored(otherwise, untested))
    return _tested(expression) if _may_be_none(expression, untested) else expression


def _tested_parts(expression: Expression) -> Expression:
    """A value from elsewhere, with a test of each real in it."""
    kind = expression.type
    if isinstance(kind, RealType):
        return _tested(expression)
    if isinstance(kind, ArrayType) and has_real(kind):
        places = (LiteralValue(type=INT, value=place) for place in range(kind.size or 0))
        elements = (ElementValue(type=kind.element, operand=expression, index=place) for place in places)
        return ArrayElements(type=kind, values=tuple(map(_tested_parts, elements)), span=expression.span)
    if isinstance(kind, StructType) and has_real(kind):
        fields = (FieldValue(type=field, operand=expression, field=name) for name, field in kind.fields)
        return StructValue(type=kind, values=tuple(map(_tested_parts, fields)), span=expression.span)
    return expression


def _may_be_none(expression: Expression, untested: set[str] | frozenset[str]) -> bool:
    """Whether a real value may be infinite or NaN."""
    if not isinstance(expression.type, RealType):
        return False
    match expression:
        case SignalValue(name=name):
            return name in untested
        case FieldValue(operand=operand) | ElementValue(operand=operand):
            return _is_part_of_any(operand, untested)
        case BinaryOperation():
            return True
        case ConditionalValue(then=then, otherwise=otherwise):
            return _may_be_none(then, untested) or _may_be_none(otherwise, untested)
        case FunctionCall(function="finite"):
            return False
        case FunctionCall(function="quantize" | "deadzone"):
            return True
        case Conversion(operand=operand):
            narrowed = expression.type.bits == 32 and isinstance(operand.type, RealType) and operand.type.bits == 64
            return narrowed or _may_be_none(operand, untested)
        case (
            LiteralValue() | ParameterValue() | TunableValue() | VariableValue() | PresentTime() | UnaryOperation()
            | FunctionCall() | StructValue() | ArrayElements()
        ):  # fmt: skip
            return any(_may_be_none(part, untested) for part in operands(expression))
        case _:
            assert_never(expression)


def _is_part_of_any(whole: Expression, untested: set[str] | frozenset[str]) -> bool:
    """Whether an array or a struct is one of ``untested``, a part of it, or made of what may be infinite or NaN."""
    while isinstance(whole, FieldValue | ElementValue):
        whole = whole.operand
    match whole:
        case SignalValue(name=name):
            return name in untested
        case StructValue(values=parts) | ArrayElements(values=parts):
            return any(_may_be_none(part, untested) or _is_part_of_any(part, untested) for part in parts)
        case ConditionalValue(then=then, otherwise=otherwise):
            return _is_part_of_any(then, untested) or _is_part_of_any(otherwise, untested)
        case _:  # What else is an array or a struct was tested when it was stored.
            return False
