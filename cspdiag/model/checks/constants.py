"""Values that are known before the program runs, wherever they stand."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.base import Report, Span
from cspdiag.model.constants.arithmetic import OutOfRangeError, UndefinedError, checked
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.diagnostics.constants import IndexOutOfRange, NumberTooLarge
from cspdiag.model.names.tree_walk import walk
from cspdiag.model.program import Program
from cspdiag.model.types import INT, TIME, UNKNOWN, ArrayType, IntType, RealType, TimeType
from cspdiag.syntax import ast


def check_constants(program: Program, report: Report) -> None:
    """Report numbers that do not fit their type, divisions by a known zero, and known indexes outside of arrays.

    What stands behind a condition may never be computed, and is left to the running program.
    """
    found = Report()
    negated = {part.operand for part in program.types if isinstance(part, ast.Unary) and part.operator == "-"}
    for part in program.types:
        match part:
            case ast.Number():
                _check_number(program, part, report, negative=part in negated)
            case ast.Duration():
                _check_duration(program, part, report)
            case ast.Binary() if part.operator in {"/", "%"}:
                _check_division(program, part, found)
            case ast.Index():
                _check_index(program, part, found)
            case _:
                pass
    if found.diagnostics:
        doubtful = {(span.file, span.start, span.end) for span in _doubtful_places(program)}
        for diagnostic in found.diagnostics:
            span = diagnostic.span
            if (span.file, span.start, span.end) not in doubtful:
                report.add(diagnostic)


_CONDITIONAL: dict[type[ast.Node], tuple[str, ...]] = {
    ast.Conditional: ("then", "otherwise"),
    ast.If: ("then", "otherwise"),
    ast.While: ("process",),
    ast.Guarded: ("process",),
}
"""Parts that are looked at only if something else holds."""


def _doubtful_places(program: Program) -> Iterator[Span]:
    """The places of all expressions that stand behind a condition."""
    for tree in program.trees:
        for part in walk(tree):
            names = _CONDITIONAL.get(type(part), ())
            if isinstance(part, ast.Binary) and part.operator in {"and", "or"}:
                names = ("right",)
            for name in names:
                inner = getattr(part, name)
                if inner is not None:
                    yield from (below.span for below in walk(inner))


def _check_duration(program: Program, duration: ast.Duration, report: Report) -> None:
    is_time = isinstance(program.types.get(duration), TimeType)
    if is_time and duration.nanoseconds > INT.maximum:
        report.add(NumberTooLarge(duration.span, type=TIME))


def _check_division(program: Program, division: ast.Binary, report: Report) -> None:
    # The left side may be a long chain, which is looked at only where there is something to report.
    if evaluate(program, division.right, {}, report) == 0:
        evaluate(program, division, {}, report)


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
