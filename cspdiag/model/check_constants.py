"""Values that are known before the program runs, wherever they stand."""

from __future__ import annotations

from cspdiag.diagnostics import Report
from cspdiag.diagnostics.record import field_names
from cspdiag.model.arithmetic import OutOfRangeError, UndefinedError, checked
from cspdiag.model.diagnostics_constants import IndexOutOfRange, NumberTooLarge
from cspdiag.model.evaluate import evaluate
from cspdiag.model.program import Program
from cspdiag.model.types import INT, TIME, UNKNOWN, ArrayType, IntType, RealType, TimeType
from cspdiag.syntax import ast


def check_constants(program: Program, report: Report) -> None:
    """Report numbers that do not fit their type, divisions by a known zero, and known indexes outside of arrays.

    What stands behind a condition may never be computed, and is left to the running program.
    """
    for tree in program.trees:
        negated: set[ast.Node] = set()
        pending: list[tuple[object, bool]] = [(tree.items, True)]
        while pending:
            part, is_certain = pending.pop()
            if isinstance(part, tuple):
                pending += [(item, is_certain) for item in part]
                continue
            if not isinstance(part, ast.Node):
                continue
            match part:
                case ast.Unary() if part.operator == "-":
                    negated.add(part.operand)
                case ast.Number():
                    _check_number(program, part, report, negative=part in negated)
                case ast.Duration():
                    _check_duration(program, part, report)
                case ast.Binary() if is_certain and part.operator in {"/", "%"}:
                    _check_division(program, part, report)
                case ast.Index() if is_certain:
                    _check_index(program, part, report)
                case _:
                    pass
            conditional = _CONDITIONAL.get(type(part), ())
            if isinstance(part, ast.Binary) and part.operator in {"and", "or"}:
                conditional = ("right",)
            for name in field_names(part):
                pending.append((getattr(part, name), is_certain and name not in conditional))


_CONDITIONAL: dict[type[ast.Node], tuple[str, ...]] = {
    ast.Conditional: ("then", "otherwise"),
    ast.If: ("then", "otherwise"),
    ast.While: ("process",),
    ast.Guarded: ("process",),
}
"""Parts that are looked at only if something else holds."""


def _check_duration(program: Program, duration: ast.Duration, report: Report) -> None:
    is_time = isinstance(program.types.get(duration), TimeType)
    if is_time and duration.nanoseconds > INT.maximum:
        report.add(NumberTooLarge(duration.span, type=TIME))


def _check_division(program: Program, division: ast.Binary, report: Report) -> None:
    # The left side may be a long chain, which is looked at only where there is something to report.
    if division not in program.poisoned and evaluate(program, division.right, {}, report) == 0:
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
