"""Expressions of a program in single precision, and those in double precision that read or make its values.

Outside the program reals are doubles, but structs are those of the program. So a value of the program that is used
there is widened, and a value for the program is rounded at the end.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import TypeAlias, TypeVar, assert_never

from cspdiag.base import Report, Span
from cspdiag.base.record import replaced
from cspdiag.model.constants.arithmetic import single
from cspdiag.model.types import INT, ArrayType, IntType, RealType, StructType, Type
from cspdiag.network.diagnostics.precision import NotInSinglePrecision, RoundedWhole
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expression_walk import walk
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
    Value,
    VariableValue,
)
from cspdiag.network.lower.precision.types import outside_type, parts_of, program_type, rounded_to

T = TypeVar("T")
Named: TypeAlias = ParameterValue | TunableValue | VariableValue | SignalValue

EXACT_IN_DOUBLE = 2.0**53
NONE: frozenset[str] = frozenset()


class Precision:
    """Changes the parts of a network; a number that single precision does not have is reported at its place."""

    def __init__(self, report: Report) -> None:
        self._report = report
        self._reported: set[tuple[Span, str]] = set()

    def inside(self, item: T, doubles: frozenset[str] = NONE) -> T:
        """A part of the program: all its types, and its literals. Parameters and signals in ``doubles`` keep their
        types.
        """
        return rewritten(item, lambda part: self._inside(part, doubles))

    def _inside(self, part: T, doubles: frozenset[str]) -> T:
        if isinstance(part, RealType | ArrayType | StructType):
            return program_type(part)  # type: ignore[return-value]
        if isinstance(part, LiteralValue):
            return self.literal(part)  # type: ignore[return-value]
        kind = getattr(part, "type", None)
        if kind is None:
            return part
        narrow = program_type(kind)
        if isinstance(part, ParameterValue | SignalValue) and part.name in doubles:
            return rounded(part, narrow)  # type: ignore[return-value]
        if isinstance(part, Conversion) and part.operand.type == narrow:
            return part.operand  # type: ignore[return-value]
        if isinstance(part, Conversion) and isinstance(part.operand, LiteralValue) and part.span is not None:
            self.check(narrow, part.operand.value, part.span)
        return part if narrow == kind else replaced(part, type=narrow)

    def literal(self, literal: LiteralValue) -> LiteralValue:
        """A literal of the program."""
        kind = program_type(literal.type)
        if kind == literal.type:
            return literal
        if literal.span is not None:
            self.check(literal.type, literal.value, literal.span)
        return replaced(literal, type=kind, value=rounded_to(kind, literal.value))

    def check(self, kind: Type, value: Value, span: Span) -> bool:
        """Report numbers that are too large or too small, or whole with too many digits; whether there were none."""
        is_fine = self.check_size(kind, value, span)
        for number in _reals(kind, value):
            near = single(number)
            if near not in (number, 0) and number.is_integer() and abs(number) <= EXACT_IN_DOUBLE:
                self._once(RoundedWhole(span, int(number), int(near)))
                is_fine = False
        return is_fine

    def check_size(self, kind: Type, value: Value, span: Span) -> bool:
        """Report numbers that are too large or too small; whether there were none."""
        is_fine = True
        for number in _reals(kind, value):
            near = single(number)
            if math.isfinite(number) and (math.isinf(near) or near == 0 != number):
                self._once(NotInSinglePrecision(span, repr(number), is_large=abs(number) > 1))
                is_fine = False
        return is_fine

    def _once(self, found: NotInSinglePrecision | RoundedWhole) -> None:
        key = (found.span, found.message)
        if key not in self._reported:
            self._reported.add(key)
            self._report.add(found)


def converts_whole_numbers(expression: Expression) -> bool:
    """Whether whole numbers become real in an expression, so that its value may be one that was meant exactly."""
    return any(isinstance(part, Conversion) and isinstance(part.operand.type, IntType) for part in walk(expression))


def _reals(kind: Type, value: Value) -> Iterator[float]:
    if isinstance(kind, RealType):
        assert isinstance(value, int | float)
        yield float(value)
    elif isinstance(value, tuple):
        for inner, part in parts_of(kind, value):
            yield from _reals(inner, part)


class Outside:
    """Expressions in double precision. ``declared`` gives the types under which names are now known."""

    def __init__(self, declared: Callable[[Named], Type], named_literals: frozenset[str] = frozenset()) -> None:
        self._declared = declared
        self._named_literals = named_literals
        """Constants of the text that are only used outside the program, and so keep their values."""

    def __call__(self, expression: Expression) -> Expression:
        """The expression, in double precision."""
        kind = outside_type(expression.type)
        match expression:
            case LiteralValue(name=name):
                if program_type(expression.type) == expression.type:
                    return expression
                kept = name if name in self._named_literals or kind == program_type(kind) else None
                return replaced(expression, type=kind, value=rounded_to(kind, expression.value), name=kept)
            case ParameterValue() | TunableValue() | VariableValue() | SignalValue() | FieldValue() | ElementValue():
                return _widened(self._place(expression), kind)
            case PresentTime():
                return expression
            case UnaryOperation(operand=operand) | Conversion(operand=operand):
                return replaced(expression, type=kind, operand=self(operand))
            case BinaryOperation(left=left, right=right):
                return replaced(expression, type=kind, left=self(left), right=self(right))
            case ConditionalValue(condition=condition, then=then, otherwise=otherwise):
                return replaced(
                    expression, type=kind, condition=self(condition), then=self(then), otherwise=self(otherwise)
                )
            case FunctionCall(arguments=arguments):
                return replaced(expression, type=kind, arguments=tuple(map(self, arguments)))
            case ArrayElements(values=values):
                return replaced(expression, type=kind, values=tuple(map(self, values)))
            case StructValue(values=values):
                assert isinstance(kind, StructType)
                fields = zip(kind.fields, values, strict=True)
                return replaced(
                    expression, type=kind, values=tuple(rounded(self(value), field) for (_, field), value in fields)
                )
            case _:
                assert_never(expression)

    def _place(self, expression: Expression) -> Expression:
        """What has a name, or an element or field of it, of the type that it has there."""
        if isinstance(expression, Named):
            return replaced(expression, type=self._declared(expression))
        if isinstance(expression, FieldValue):
            whole = self._place(expression.operand)
            assert isinstance(whole.type, StructType)
            return replaced(expression, operand=whole, type=whole.type.field(expression.field))
        if isinstance(expression, ElementValue):
            whole = self._place(expression.operand)
            assert isinstance(whole.type, ArrayType)
            return replaced(expression, operand=whole, index=self(expression.index), type=whole.type.element)
        return self(expression)


def _widened(expression: Expression, kind: Type) -> Expression:
    if expression.type == kind:
        return expression
    if isinstance(kind, ArrayType):
        return _by_elements(expression, kind, _widened)
    return Conversion(type=kind, operand=expression, span=expression.span)


def rounded(expression: Expression, kind: Type) -> Expression:
    """An expression in double precision as a value of the program."""
    if expression.type == kind:
        return expression
    if isinstance(expression, LiteralValue):
        return replaced(expression, type=kind, value=rounded_to(kind, expression.value), name=None)
    if isinstance(expression, Conversion) and expression.operand.type == kind:
        return expression.operand
    if isinstance(expression, FunctionCall) and expression.function == "finite":
        (value,) = expression.arguments
        return replaced(expression, type=kind, arguments=(rounded(value, kind),))
    if isinstance(expression, ArrayElements) and isinstance(kind, ArrayType):
        return replaced(
            expression, type=kind, values=tuple(rounded(value, kind.element) for value in expression.values)
        )
    if isinstance(expression, ConditionalValue) and isinstance(kind, ArrayType):
        return replaced(
            expression,
            type=kind,
            then=rounded(expression.then, kind),
            otherwise=rounded(expression.otherwise, kind),
        )
    if isinstance(kind, ArrayType):
        return _by_elements(expression, kind, rounded)
    return Conversion(type=kind, operand=expression, span=expression.span)


def rounded_and_tested(expression: Expression, kind: Type) -> Expression:
    """The same, where the result is stored: a number too large for single precision is a fault."""
    value = rounded(expression, kind)
    if isinstance(value, Conversion) and isinstance(kind, RealType):
        return FunctionCall(type=kind, function="finite", arguments=(value,), span=value.span)
    if isinstance(value, ArrayElements) and isinstance(kind, ArrayType):
        return replaced(value, values=tuple(rounded_and_tested(part, kind.element) for part in value.values))
    return value


def _by_elements(
    expression: Expression, kind: ArrayType, change: Callable[[Expression, Type], Expression]
) -> Expression:
    assert isinstance(expression.type, ArrayType)
    assert kind.size is not None
    elements = (
        ElementValue(type=expression.type.element, operand=expression, index=LiteralValue(type=INT, value=place))
        for place in range(kind.size)
    )
    return ArrayElements(
        type=kind, values=tuple(change(element, kind.element) for element in elements), span=expression.span
    )


def known_by_name(values: Mapping[str, Value]) -> Callable[[ParameterValue | SignalValue], Value | None]:
    """A look-up of names for ``constant_value``."""
    return lambda part: values.get(part.name)
