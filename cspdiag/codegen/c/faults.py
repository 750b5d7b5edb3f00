"""Whether the evaluation of an expression can end in a fault.

Only then does generated C look after a statement whether there was one.
"""

from __future__ import annotations

from cspdiag.model.types import IntType, RealType, TimeType
from cspdiag.network.expression_walk import walk
from cspdiag.network.expressions import (
    BinaryOperation,
    Conversion,
    ElementValue,
    Expression,
    FunctionCall,
    LiteralValue,
    UnaryOperation,
)
from cspdiag.network.ranges import needs_check, value_range


def can_fault(expression: Expression) -> bool:
    """Whether the expression or a part of it can fault."""
    return any(operation_can_fault(part) for part in walk(expression))


def operation_can_fault(expression: Expression) -> bool:
    """Whether the operation itself can, its operands once had."""
    match expression:
        case BinaryOperation(operator="/" | "%") if divisor_can_be_zero(expression):
            return True
        case BinaryOperation(operator="+" | "-" | "*" | "/" | "^") | UnaryOperation(operator="-"):
            return _is_whole(expression) and (needs_check(expression) or _is_power(expression))
        case FunctionCall(function="finite"):
            return True
        case FunctionCall(function="abs" | "min" | "max"):
            return _is_whole(expression) and needs_check(expression)
        case Conversion():
            return not fits(expression)
        case ElementValue(index=index):
            return not isinstance(index, LiteralValue)
    return False


def divisor_can_be_zero(expression: BinaryOperation) -> bool:
    """Whether a division by zero has to be looked for: also of reals, but not where ``%`` means C's ``fmod``."""
    if expression.operator == "%" and not isinstance(expression.left.type, IntType | TimeType):
        return False
    divisor = expression.right
    return not (isinstance(divisor, LiteralValue) and divisor.value != 0)


def fits(conversion: Conversion) -> bool:
    """Whether every value of the operand has one in the type that it is converted to."""
    if isinstance(conversion.type, RealType):
        return True
    if not isinstance(conversion.operand.type, IntType | TimeType):
        return not isinstance(conversion.operand.type, RealType)
    low, high = value_range(conversion.operand)
    kind = conversion.type if isinstance(conversion.type, IntType) else IntType()
    return kind.minimum <= low and high <= kind.maximum


def _is_whole(expression: Expression) -> bool:
    return isinstance(expression.type, IntType | TimeType)


def _is_power(expression: Expression) -> bool:
    return isinstance(expression, BinaryOperation) and expression.operator == "^"
