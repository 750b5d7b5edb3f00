"""Values of expressions while the states of a process are explored: known ones, ranges of whole numbers, and unknown
ones.

A variable has a known value; a range that it lies in, if the environment gave it or it has too many values to be
distinguished; or it is ``UNKNOWN``, such as what a control law computed.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator
from itertools import product
from typing import Any, Final, Literal, TypeAlias, assert_never

from cspdiag.base.record import record
from cspdiag.model.constants import arithmetic
from cspdiag.model.types import (
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
from cspdiag.proofs.transitions.ranges import Range, computed
from cspdiag.proofs.transitions.ranges import compared as compared_ranges


class UnknownValue:
    """The type of ``UNKNOWN``."""

    __slots__ = ()

    def __repr__(self) -> str:
        return "?"


UNKNOWN: Final = UnknownValue()


@record(order=True)
class CopiedValue:
    """A value of an input that is only passed on, and of which nothing else is known: ``one`` that represents every
    value, ``another`` that differs from it, or ``any`` value that a specification chooses.
    """

    which: Literal["one", "another", "any"]

    def __str__(self) -> str:
        return f"({self.which} value)"


COPIES: Final = (CopiedValue("one"), CopiedValue("another"))
ANY: Final = CopiedValue("any")
Known: TypeAlias = "Value | Range | CopiedValue | UnknownValue"
"""What is known of a value: the value itself, the range that it lies in, that it is only passed on, or nothing."""

Variables: TypeAlias = Callable[[str], Known]
"""The present value of a variable of the class."""

Parameters: TypeAlias = Callable[[str], Known]


class EvaluationFault(Exception):  # noqa: N818 - the language's own word
    """The evaluation ends in a fault, whatever the unknown values are."""


def evaluated(expression: Expression, variables: Variables, parameters: Parameters) -> Known:
    """The value of an expression as far as it is known. Raises EvaluationFault if it certainly fails."""
    try:
        return _Evaluation(variables, parameters).value(expression)  # type: ignore[no-any-return]
    except _FAILURES as problem:
        raise EvaluationFault(str(problem)) from None


_FAILURES = (arithmetic.UndefinedError, arithmetic.OutOfRangeError, ArithmeticError, ValueError, IndexError)


class _Evaluation:
    def __init__(self, variables: Variables, parameters: Parameters) -> None:
        self.variables = variables
        self.parameters = parameters

    def value(self, expression: Expression) -> Any:
        match expression:
            case LiteralValue():
                return expression.value
            case VariableValue():
                return self.variables(expression.channel)
            case ParameterValue():
                return self.parameters(expression.name)
            case BinaryOperation():
                return self._binary(expression)
            case UnaryOperation():
                operand = self.value(expression.operand)
                if _is_opaque(operand):
                    return UNKNOWN
                if isinstance(operand, Range):
                    return _ranged(computed("-", 0, operand, expression.type))
                if expression.operator == "not":
                    return not operand
                if isinstance(expression.type, RealType):
                    return -operand
                return arithmetic.operate("-", 0, operand, expression.type)
            case ConditionalValue():
                condition = self.value(expression.condition)
                if condition is not UNKNOWN:
                    return self.value(expression.then if condition else expression.otherwise)
                return self._either(expression.then, expression.otherwise)
            case FunctionCall():
                arguments = [self.value(argument) for argument in expression.arguments]
                if not all(map(is_exact, arguments)):
                    return UNKNOWN
                if expression.function == "seconds":
                    return arithmetic.checked(arguments[0] / 1_000_000_000, expression.type)
                return arithmetic.function(expression.function, arguments, expression.type)
            case Conversion():
                operand = self.value(expression.operand)
                assert isinstance(expression.type, IntType | RealType)
                return self._converted(operand, expression.type)
            case FieldValue():
                assert isinstance(expression.operand.type, StructType)
                whole = self.value(expression.operand)
                names = [name for name, _ in expression.operand.type.fields]
                return UNKNOWN if _is_opaque(whole) else whole[names.index(expression.field)]
            case ElementValue():
                return self._element(expression)
            case StructValue() | ArrayElements():
                parts = tuple(map(self.value, expression.values))
                return parts if all(map(is_exact, parts)) else UNKNOWN
            case TunableValue() | SignalValue() | PresentTime():
                return UNKNOWN
            case _:
                assert_never(expression)

    def _either(self, one: Expression, other: Expression) -> Any:
        """The value of two expressions of which only one is computed, and it is not known which. Fails if both do."""
        try:
            value = self.value(one)
        except _FAILURES:
            self.value(other)
            return UNKNOWN
        return value if same(value, self._if_computed(other)) else UNKNOWN

    def _if_computed(self, expression: Expression) -> Any:
        """The value of an expression that may not be computed at all, and does not fail then."""
        try:
            return self.value(expression)
        except _FAILURES:
            return UNKNOWN

    def _converted(self, operand: Known, kind: IntType | RealType) -> Known:
        if not is_exact(operand):
            return UNKNOWN
        try:
            return arithmetic.convert(operand, kind)  # type: ignore[arg-type]
        except arithmetic.OutOfRangeError:
            if isinstance(kind, RealType):
                return UNKNOWN
            raise

    def _element(self, expression: ElementValue) -> Any:
        index, whole = self.value(expression.index), self.value(expression.operand)
        if not is_exact(index) or _is_opaque(whole):
            return UNKNOWN
        if index < 0:
            raise IndexError(f"there is no element {index}")
        return whole[index]

    def _binary(self, expression: BinaryOperation) -> Any:
        left = self.value(expression.left)
        if expression.operator in ("and", "or"):
            decisive = expression.operator == "or"
            if left is not UNKNOWN and left == decisive:
                return left
            if left is not UNKNOWN:
                return self.value(expression.right)
            right = self._if_computed(expression.right)
            return right if right is not UNKNOWN and right == decisive else UNKNOWN
        right = self.value(expression.right)
        if _is_opaque(left) or _is_opaque(right):
            return UNKNOWN
        if isinstance(left, Range) or isinstance(right, Range):
            if expression.operator in _COMPARISONS:
                return _ranged(compared_ranges(expression.operator, left, right))
            return _ranged(computed(expression.operator, left, right, expression.type))
        compare = _COMPARISONS.get(expression.operator)
        if compare is not None:
            return compare(left, right)
        try:
            return arithmetic.operate(expression.operator, left, right, expression.type)
        except arithmetic.OutOfRangeError:
            if isinstance(expression.type, RealType):
                return UNKNOWN  # Within an expression an infinity is a value.
            raise


_COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "==": operator.eq, "!=": operator.ne, "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
}  # fmt: skip


def is_exact(value: Known) -> bool:
    """Whether a value is known exactly."""
    return not isinstance(value, UnknownValue | Range | CopiedValue)


def _is_opaque(value: Known) -> bool:
    return isinstance(value, UnknownValue | CopiedValue)


def _ranged(found: Known | None) -> Known:
    return UNKNOWN if found is None else found


def same(one: Known, other: Known) -> bool:
    """Whether two values are identical: ``1`` and ``true`` are not, nor are ``0.0`` and ``-0.0``."""
    return one is other or (type(one) is type(other) and repr(one) == repr(other))


def replaced_element(whole: Known, indexes: tuple[Known, ...], value: Known) -> Known:
    """An array with one element, at nested ``indexes``, replaced. Raises EvaluationFault for an index out of range."""
    if not indexes:
        return value
    index = indexes[0]
    if _is_opaque(whole) or not is_exact(index):
        return UNKNOWN
    assert isinstance(whole, tuple)
    assert isinstance(index, int)
    if not 0 <= index < len(whole):
        raise EvaluationFault(f"there is no element {index}")
    inner = replaced_element(whole[index], indexes[1:], value)
    return (
        UNKNOWN
        if isinstance(inner, UnknownValue | Range | CopiedValue)
        else (*whole[:index], inner, *whole[index + 1 :])
    )


def values_of_type(kind: Type) -> tuple[Value, ...] | None:
    """All values of a type that has few of them; None for other types."""
    match kind:
        case BoolType():
            return (False, True)
        case EnumType(literals=literals) if len(literals) <= MOST_VALUES:
            return tuple(range(len(literals)))
        case StructType(fields=fields):
            parts = [values_of_type(field) for _, field in fields]
            if all(part is not None for part in parts):
                combined = list(product(*(part for part in parts if part is not None)))
                return tuple(combined) if len(combined) <= _FEW else None
            return None
        case EnumType() | IntType() | RealType() | TimeType() | TextType() | ArrayType() | UnknownType():
            return None
        case _:
            assert_never(kind)


MOST_VALUES = 64
"""Of a variable or a channel with more values than that, the values are not distinguished."""
_FEW = 8


def variables_in(expression: Expression) -> Iterator[VariableValue]:
    """The variables that an expression mentions."""
    return (part for part in walk(expression) if isinstance(part, VariableValue))
