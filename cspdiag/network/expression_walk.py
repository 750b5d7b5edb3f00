"""What an expression is made of, and what it reads."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import assert_never

from cspdiag.diagnostics.record import replaced
from cspdiag.network.expressions import (
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
    UnaryOperation,
    VariableValue,
)


def operands(expression: Expression) -> tuple[Expression, ...]:
    """The expressions directly inside, in text order."""
    match expression:
        case LiteralValue() | ParameterValue() | VariableValue() | SignalValue() | PresentTime():
            return ()
        case UnaryOperation() | Conversion() | FieldValue():
            return (expression.operand,)
        case BinaryOperation():
            return (expression.left, expression.right)
        case ConditionalValue():
            return (expression.condition, expression.then, expression.otherwise)
        case FunctionCall():
            return expression.arguments
        case ElementValue():
            return (expression.operand, expression.index)
        case StructValue() | ArrayElements():
            return expression.values
        case _:
            assert_never(expression)


def walk(expression: Expression) -> Iterator[Expression]:
    """The expression and everything inside it, in text order; a long chain of operators does not recurse."""
    pending = [expression]
    while pending:
        present = pending.pop()
        yield present
        pending.extend(reversed(operands(present)))


def signals_read(expression: Expression) -> list[str]:
    """Names of the signals that an expression reads, each once, in text order."""
    return list(dict.fromkeys(part.name for part in walk(expression) if isinstance(part, SignalValue)))


def with_leaves(expression: Expression, replace: Callable[[Expression], Expression | None]) -> Expression:
    """A copy in which every expression for which ``replace`` gives another one is replaced by it."""
    other = replace(expression)
    if other is not None:
        return other

    def inner(part: Expression) -> Expression:
        return with_leaves(part, replace)

    match expression:
        case LiteralValue() | ParameterValue() | VariableValue() | SignalValue() | PresentTime():
            return expression
        case UnaryOperation() | Conversion() | FieldValue():
            return replaced(expression, operand=inner(expression.operand))
        case BinaryOperation():
            return _with_leaves_of_chain(expression, replace)
        case ConditionalValue():
            return replaced(
                expression,
                condition=inner(expression.condition),
                then=inner(expression.then),
                otherwise=inner(expression.otherwise),
            )
        case FunctionCall():
            return replaced(expression, arguments=tuple(map(inner, expression.arguments)))
        case ElementValue():
            return replaced(expression, operand=inner(expression.operand), index=inner(expression.index))
        case StructValue() | ArrayElements():
            return replaced(expression, values=tuple(map(inner, expression.values)))
        case _:
            assert_never(expression)


def _with_leaves_of_chain(
    expression: BinaryOperation, replace: Callable[[Expression], Expression | None]
) -> Expression:
    """Like ``with_leaves``, going down the left side of a chain of operators by a loop."""
    chain = [expression]
    while isinstance(chain[-1].left, BinaryOperation) and replace(chain[-1].left) is None:
        chain.append(chain[-1].left)
    result = with_leaves(chain[-1].left, replace)
    for operation in reversed(chain):
        result = replaced(operation, left=result, right=with_leaves(operation.right, replace))
    return result
