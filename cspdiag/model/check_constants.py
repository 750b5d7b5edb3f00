"""Values that are known before the program runs, wherever they stand."""

from __future__ import annotations

from cspdiag.diagnostics import Report
from cspdiag.model.arithmetic import OutOfRangeError, UndefinedError, checked
from cspdiag.model.diagnostics_constants import IndexOutOfRange, NumberTooLarge
from cspdiag.model.evaluate import evaluate
from cspdiag.model.graphs import walk
from cspdiag.model.program import Program
from cspdiag.model.types import UNKNOWN, ArrayType, IntType, RealType, TimeType
from cspdiag.syntax import ast


def check_constants(program: Program, report: Report) -> None:
    """Report numbers that do not fit their type, divisions by a known zero, and known indexes outside of arrays."""
    for tree in program.trees:
        negated: set[ast.Node] = set()
        for part in walk(tree):
            match part:
                case ast.Unary() if part.operator == "-":
                    negated.add(part.operand)
                case ast.Number():
                    _check_number(program, part, report, negative=part in negated)
                case ast.Duration() if isinstance(program.types.get(part), TimeType):
                    if part.nanoseconds > IntType().maximum:
                        report.add(NumberTooLarge(part.span, type=TimeType()))
                case ast.Binary() if part.operator in {"/", "%"} and part not in program.poisoned:
                    # The left side may be a long chain, which is looked at only where there is something to report.
                    if evaluate(program, part.right, {}, report) == 0:
                        evaluate(program, part, {}, report)
                case ast.Index():
                    _check_index(program, part, report)
                case _:
                    pass


def _check_number(program: Program, number: ast.Number, report: Report, *, negative: bool) -> None:
    found = program.types.get(number, UNKNOWN)
    if number in program.poisoned or not isinstance(found, IntType | RealType):
        return
    try:
        checked(-number.value if negative else number.value, found)
    except (OutOfRangeError, UndefinedError, OverflowError):
        report.add(NumberTooLarge(number.span, type=found))


def _check_index(program: Program, index: ast.Index, report: Report) -> None:
    found = program.types.get(index.value, UNKNOWN)
    if not isinstance(found, ArrayType) or found.size is None or index in program.poisoned:
        return
    value = evaluate(program, index.index, {}, report)
    if isinstance(value, int) and not 0 <= value < found.size:
        report.add(IndexOutOfRange(index.index.span, index=value, size=found.size))
