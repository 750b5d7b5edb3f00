"""Assignments of expressions that take more than one statement."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.codegen.python.fast.expressions import FastPrinter
from cspdiag.codegen.python.text.code import (
    COMPARISON,
    PRODUCT,
    SUM,
    Atom,
    Code,
    Conditional,
    Parenthesized,
    call,
    infix,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.statements import Block, Line, Statement, Unpack, assign, run
from cspdiag.network.ir.expressions import BinaryOperation, Expression, FunctionCall


def assigned(target: str, printer: FastPrinter, expression: Expression, place: str | None) -> Iterable[Statement]:
    """``target = expression``, with what has to be computed before it; ``place`` is noted as a comment."""
    match expression:
        case FunctionCall(function="round", arguments=(operand,)):
            yield from _rounded(target, printer, operand, None, place)
        case FunctionCall(function="quantize", arguments=(operand, step)) if printer.value(step):
            ratio = BinaryOperation(type=expression.type, operator="/", left=operand, right=step)
            yield from _rounded(target, printer, ratio, printer.print(step), place)
        case _:
            yield assign(target, printer.print(expression), place)


def refused_unless_finite(name: str, imports: Imports) -> Statement:
    """Raises a fault for a real in a local variable that is infinite or no number: only then it differs from itself."""
    difference = infix("!=", COMPARISON, infix("-", SUM, Atom(name), Atom(name)), Atom("0.0"))
    return Block(Line("if ", difference, ":"), (run(call(imports.runtime("finite"), Atom(name))),))


def _rounded(
    target: str, printer: FastPrinter, operand: Expression, step: Code | None, place: str | None
) -> Iterable[Statement]:
    """To the nearest whole number, halves away from zero: ``modf`` is exact and keeps the sign of a zero."""
    with printer.temporaries.whole_expression():
        code = printer.print(operand)
        fraction, whole = (Atom(printer.temporaries.fresh(operand.type)) for _ in range(2))
    one = Atom("1.0")
    down = Conditional(infix("-", SUM, whole, one), infix("<=", COMPARISON, fraction, Atom("-0.5")), whole)
    nearest = Conditional(infix("+", SUM, whole, one), infix(">=", COMPARISON, fraction, Atom("0.5")), down)
    yield Unpack((fraction.text, whole.text), call(printer.imports.standard("math", "modf"), code), place)
    yield assign(target, nearest if step is None else infix("*", PRODUCT, Parenthesized(nearest), step))
