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
    """``target = expression``, with what has to be computed before it; ``place`` is noted as a comment, an
    ``annotation`` declares the target.
    """
    match expression:
        case FunctionCall(function="round", arguments=(operand,)):
            before, value = _rounded(printer, operand, None, place)
        case FunctionCall(function="quantize", arguments=(operand, step)) if printer.value(step):
            ratio = BinaryOperation(type=expression.type, operator="/", left=operand, right=step)
            before, value = _rounded(printer, ratio, printer.print(step), place)
        case _:  # Every other value is one expression.
            yield Assign(target, printer.print(expression), place, annotation=annotation)
            return
    yield before
    yield Assign(target, value, annotation=annotation)


def refused_unless_finite(value: Code, imports: Imports) -> Statement:
    """Raises a fault for a real in a local variable that is infinite or no number: only then it differs from itself."""
    difference = infix("!=", COMPARISON, infix("-", SUM, value, value), Constant("0.0"))
    return if_(difference, run(call(imports.runtime("finite"), value)))


def _rounded(printer: FastPrinter, operand: Expression, step: Code | None, place: str | None) -> tuple[Statement, Code]:
    """To the nearest whole number, halves away from zero: ``modf`` is exact and keeps the sign of a zero."""
    with printer.temporaries.whole_expression():
        code = printer.print(operand)
        fraction, whole = (Name(printer.temporaries.fresh(operand.type)) for _ in range(2))
    one = Constant("1.0")
    down = Conditional(infix("-", SUM, whole, one), infix("<=", COMPARISON, fraction, number("-0.5")), whole)
    nearest = Conditional(infix("+", SUM, whole, one), infix(">=", COMPARISON, fraction, Constant("0.5")), down)
    value = nearest if step is None else infix("*", PRODUCT, Parenthesized(nearest), step)
    return unpack([fraction, whole], call(printer.imports.standard("math", "modf"), code), place), value
