"""Assignments of expressions that take more than one statement."""

from __future__ import annotations

from collections.abc import Iterable

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
    infix,
    number,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.statements import Assign, Statement, if_, run, unpack
from cspdiag.network.ir.expressions import BinaryOperation, Expression, FunctionCall


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


def refused_unless_finite(value: Code, imports: Imports, place: str | None = None) -> Statement:
    """Raise a fault if a real in a local variable is infinite or NaN: only then its difference from itself is
    not zero.
    """
    difference = infix("!=", COMPARISON, infix("-", SUM, value, value), Constant("0.0"))
    return if_(difference, run(call(imports.runtime("finite"), value), place))


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
