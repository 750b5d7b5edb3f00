"""Python expressions with operators, whose operands get the parentheses that they need."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.codegen.python.text.code import NOT, PARENTHESES, SIGN, Chain, Code, Prefix, at_least


def negated(item: Code) -> Prefix:
    """``not x``."""
    return Prefix("not ", at_least(item, NOT))


def minus(item: Code) -> Code:
    """``-x``."""
    return Prefix("-", at_least(item, SIGN))


def infix(operator: str, precedence: int, left: Code, right: Code) -> Code:
    """``left operator right`` for an operator that groups to the left; comparisons do not chain."""
    first, second = PARENTHESES.operands(precedence, left, right)
    if isinstance(first, Chain) and first.level == precedence:
        return Chain(precedence, first.first, (*first.rest, (operator, second)))
    return Chain(precedence, first, ((operator, second),))


def infix_all(operator: str, precedence: int, operands: Sequence[Code]) -> Code:
    """``a operator b operator c``."""
    first, *rest = operands
    for operand in rest:
        first = infix(operator, precedence, first, operand)
    return first
