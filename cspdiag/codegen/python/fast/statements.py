"""Assignments of expressions that take more than one statement."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeGuard

from cspdiag.codegen.python.fast.expressions import FastPrinter
from cspdiag.codegen.python.text.code import (
    COMPARISON,
    PRODUCT,
    SUM,
    Code,
    Conditional,
    Constant,
    Name,
    Parenthesized,
    call,
    number,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.operators import infix, infix_all, negated
from cspdiag.codegen.python.text.statements import Assign, Statement, if_, run, unpack
from cspdiag.network.ir.expressions import BinaryOperation, Expression, FunctionCall

_TERMS = 16
"""How many values one sum tests."""


def assigned(
    target: Code, printer: FastPrinter, expression: Expression, place: str | None, annotation: str | None = None
) -> Iterable[Statement]:
    """``target = expression``, after what has to be computed before; ``place`` becomes a comment, ``annotation``
    declares the target.
    """
    match expression:
        case FunctionCall(function="round", arguments=(operand,)):
            before, value = _rounded(printer, operand, None, place)
        case FunctionCall(function="quantize", arguments=(operand, step)) if printer.value(step):
            ratio = BinaryOperation(type=expression.type, operator="/", left=operand, right=step)
            before, value = _rounded(printer, ratio, printer.print(step), place)
        case _:  # Any other value is a single expression.
            yield Assign(target, printer.print(expression), place, annotation=annotation)
            return
    yield before
    yield Assign(target, value, annotation=annotation)


def is_test(value: Expression) -> TypeGuard[FunctionCall]:
    """Whether a value is one that must be finite."""
    return isinstance(value, FunctionCall) and value.function == "finite"


def refused_unless_finite(value: Code, place: str | None, imports: Imports) -> Statement:
    """Raise a fault if a real in a local variable is infinite or NaN: only then its difference from itself is
    not zero.
    """
    difference = infix("!=", COMPARISON, infix("-", SUM, value, value), Constant("0.0"))
    return if_(difference, run(call(imports.runtime("finite"), value), place))


def refused_unless_all_finite(values: Sequence[tuple[Code, str | None]], imports: Imports) -> Iterable[Statement]:
    """Raise a fault for the first of several reals in local variables that is infinite or NaN, at its place.

    A sum is finite only if all its terms are. If it is not, each is tested: finite terms may have an infinite sum.
    """
    for begin in range(0, len(values), _TERMS):
        tested = values[begin : begin + _TERMS]
        if len(tested) == 1:
            yield refused_unless_finite(*tested[0], imports)
            continue
        total = infix_all("+", SUM, [value for value, _ in tested])
        tests = [run(call(imports.runtime("finite"), value), place) for value, place in tested]
        yield if_(negated(call(imports.standard("math", "isfinite"), total)), *tests)


def _rounded(printer: FastPrinter, operand: Expression, step: Code | None, place: str | None) -> tuple[Statement, Code]:
    """Round to the nearest whole number, halves away from zero: ``modf`` is exact and keeps the sign of a zero."""
    with printer.temporaries.whole_expression():
        code = printer.print(operand)
        fraction, whole = (Name(printer.temporaries.fresh(operand.type)) for _ in range(2))
    one = Constant("1.0")
    down = Conditional(infix("-", SUM, whole, one), infix("<=", COMPARISON, fraction, number("-0.5")), whole)
    nearest = Conditional(infix("+", SUM, whole, one), infix(">=", COMPARISON, fraction, Constant("0.5")), down)
    value = nearest if step is None else infix("*", PRODUCT, Parenthesized(nearest), step)
    return unpack([fraction, whole], call(printer.imports.standard("math", "modf"), code), place), value
