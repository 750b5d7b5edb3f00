"""Which expressions can end a process with a ``Fault``, for all targets, passes and analyses.

Values that are known before the run are no exception: if an index or an operand that is a literal, a parameter or the
index of a replicator is out of range, it is a fault during the run like any other, at its place and only if it is
reached.
"""

from __future__ import annotations

from typing import assert_never

from cspdiag.model.types import ArrayType, IntType, RealType, TimeType, Type
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
    VariableValue,
)
from cspdiag.network.ir.ranges import needs_check, value_range
from cspdiag.network.ir.walk import may_change


def may_fault(expression: Expression) -> bool:
    """Whether evaluating the expression can fault.

    Overflow of whole numbers, division by zero (also of reals), conversions out of range and indexes out of range are
    faults. So is reading a variable that has not been written, which is not considered here: a pass that moves an
    expression across a write of its variables has to check that itself.
    """
    return any(map(operation_may_fault, walk(expression)))


def is_known_at_start(expression: Expression) -> bool:
    """Whether an expression can be evaluated before the process runs: its value does not change, and it
    cannot fault.
    """
    return not may_change(expression) and not may_fault(expression)


def variables_in(expression: Expression) -> frozenset[str]:
    """The variables that an expression reads."""
    return frozenset(part.channel for part in walk(expression) if isinstance(part, VariableValue))


def operation_may_fault(part: Expression) -> bool:
    """Whether the operation itself can fault, apart from its operands."""
    match part:
        case (
            LiteralValue()
            | ParameterValue()
            | TunableValue()
            | VariableValue()
            | SignalValue()
            | PresentTime()
            | ConditionalValue()
            | FieldValue()
            | StructValue()
            | ArrayElements()
        ):
            return False
        case BinaryOperation(operator="/" | "%") if divisor_may_be_zero(part):
            return True
        case UnaryOperation() | BinaryOperation():
            return _is_whole(part) and needs_check(part)
        case FunctionCall(function="finite"):
            return True
        case FunctionCall(function="sign" | "seconds"):
            return False
        case FunctionCall():
            return _is_whole(part) and needs_check(part)
        case Conversion():
            return not conversion_fits(part)
        case ElementValue():
            return not index_fits(part)
        case _:
            assert_never(part)


def divisor_may_be_zero(operation: BinaryOperation) -> bool:
    """Whether the right operand of a division, or of ``%``, can be zero; also if it may fault, since in C its
    evaluation then continues with an arbitrary value.
    """
    divisor = operation.right
    if isinstance(divisor.type, RealType):
        return not (isinstance(divisor, LiteralValue) and divisor.value != 0)
    low, high = value_range(divisor)
    return low <= 0 <= high or may_fault(divisor)


def conversion_fits(conversion: Conversion) -> bool:
    """Whether every value of the operand is in the range of the type that it is converted to."""
    if isinstance(conversion.type, RealType):
        return True
    if not isinstance(conversion.operand.type, IntType | TimeType):
        return not isinstance(conversion.operand.type, RealType)
    low, high = value_range(conversion.operand)
    kind = conversion.type if isinstance(conversion.type, IntType) else IntType()
    return kind.minimum <= low and high <= kind.maximum


def index_fits(element: ElementValue) -> bool:
    """Whether every value of the index is in range."""
    return is_index_of(element.index, element.operand.type)


def is_index_of(index: Expression, array: Type) -> bool:
    """Whether every value of an index is in the range of an array type; False if the index can fault, since in C it
    then has an arbitrary value.
    """
    if not isinstance(array, ArrayType) or array.size is None or may_fault(index):
        return False
    low, high = value_range(index)
    return low >= 0 and high < array.size


def _is_whole(part: Expression) -> bool:
    operators = ("==", "!=", "<", "<=", ">", ">=", "and", "or", "not")
    if isinstance(part, BinaryOperation | UnaryOperation) and part.operator in operators:
        return False
    return not isinstance(part.type, RealType)
