"""Checks of values that are known before the program runs."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from cspdiag.base import Diagnostic, Report, Span
from cspdiag.model.constants.arithmetic import OutOfRangeError, UndefinedError, checked
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.diagnostics.constants import (
    CertainFault,
    ConstantDivision,
    ConstantOverflow,
    IndexOutOfRange,
    NumberTooLarge,
)
from cspdiag.model.program import Program
from cspdiag.model.remembered import Checks
from cspdiag.model.types import INT, TIME, UNKNOWN, ArrayType, IntType, RealType, TimeType, Type
from cspdiag.syntax import ast
from cspdiag.syntax.walk import nodes


def check_constants(program: Program, report: Report, checks: Checks) -> None:
    """Report numbers that do not fit their type, and warn of expressions in compositions and equations that always
    fault.

    Constants and initial values were evaluated when their types were determined; their faults are errors.
    """
    negated = {part.operand for part in program.types if isinstance(part, ast.Unary) and part.operator == "-"}
    for part in program.types:
        match part:
            case ast.Number():
                _check_number(program, part, report, negative=part in negated)
            case ast.Duration():
                _check_duration(program, part, report, negative=part in negated)
            case _:  # Any other expression.
                pass
    _warn_of_faults(program, report, checks)


def _warn_of_faults(program: Program, report: Report, checks: Checks) -> None:
    """Warn of expressions in compositions and equations that fault, except where a condition may prevent it."""
    found = Report()
    has_indexes = any(isinstance(part, ast.Index) for part in program.types)

    def evaluate_all(item: ast.Item, found: Report) -> None:
        for part in nodes(item):
            kind = type(part)
            if kind not in _AT_RUN_TIME and kind is not ast.Reference:
                continue  # Most are names.
            for expression in _evaluated_at_run_time(program, part):
                evaluate(program, expression, {}, found)
                for inner in nodes(expression) if has_indexes else ():
                    if isinstance(inner, ast.Index) and inner not in program.poisoned:
                        _check_index(program, inner.index, program.types.get(inner.value, UNKNOWN), found)
            if isinstance(part, ast.Reference) and part.indexes:
                _check_element(program, part, found)

    for tree in program.trees:
        for item in tree.items:
            checks.result("faults", item, "", partial(evaluate_all, item), found)
    faults = [one for one in found.diagnostics if _is_fault(one)]
    if not faults:
        return
    elsewhere = {*map(_place, _conditional_places(program)), *(_place(one.span) for one in report.diagnostics)}
    for fault in faults:
        if _place(fault.span) not in elsewhere:
            report.add(CertainFault(fault.span, problem=fault.message))


_AT_RUN_TIME: dict[type[ast.Node], str] = {
    **dict.fromkeys((ast.Write, ast.OutputGuard, ast.Assign, ast.Equation, ast.Let, ast.Next, ast.Derivative), "value"),
    **dict.fromkeys((ast.Wait, ast.TimeGuard), "time"),
    **dict.fromkeys((ast.Guard, ast.If, ast.While), "condition"),
    ast.Mu: "until",
}
"""The field with the expression that is evaluated in a step, a guard or an equation; None where it is left out."""


def _evaluated_at_run_time(program: Program, part: ast.Node) -> tuple[ast.Expression, ...]:
    """The expressions that are evaluated in a step, a guard or an equation."""
    field = _AT_RUN_TIME.get(type(part))
    if field is not None:
        expression: ast.Expression | None = getattr(part, field)
        return () if expression is None else (expression,)
    if isinstance(part, ast.Reference) and part.indexes and isinstance(program.bindings.get(part), ast.Variable):
        return part.indexes
    return ()


def _is_fault(found: Diagnostic) -> bool:
    """Whether a diagnostic about a value means a fault at run time: reals become infinite instead."""
    match found:
        case ConstantOverflow():
            return not isinstance(found.type, RealType)
        case ConstantDivision() | IndexOutOfRange():
            return True
        case _:  # Any other diagnostic.
            return False


def _place(span: Span) -> tuple[str, int, int]:
    return span.file, span.start, span.end


_CONDITIONAL: dict[type[ast.Node], tuple[str, ...]] = {
    ast.Conditional: ("then", "otherwise"),
    ast.If: ("then", "otherwise"),
    ast.While: ("process",),
    ast.Guarded: ("process",),
}
"""Fields of nodes that are evaluated only if another part has a certain value."""


def _conditional_places(program: Program) -> Iterator[Span]:
    """The places of all expressions that are evaluated only under a condition."""
    for tree in program.trees:
        for part in nodes(tree):
            names = _CONDITIONAL.get(type(part), ())
            if isinstance(part, ast.Binary) and part.operator in {"and", "or"}:
                names = ("right",)
            for name in names:
                inner = getattr(part, name)
                if inner is not None:
                    yield from (below.span for below in nodes(inner))


def _check_duration(program: Program, duration: ast.Duration, report: Report, *, negative: bool) -> None:
    """Report a duration that is too long; the most negative one is a minus and one more than the longest."""
    is_time = isinstance(program.types.get(duration), TimeType)
    if is_time and duration.nanoseconds > INT.maximum + negative:
        report.add(NumberTooLarge(duration.span, type=TIME))


def _check_number(program: Program, number: ast.Number, report: Report, *, negative: bool) -> None:
    found = program.types.get(number, UNKNOWN)
    if number in program.poisoned or not isinstance(found, IntType | RealType):
        return
    try:
        checked(-number.value if negative else number.value, found)
    except (OutOfRangeError, UndefinedError, OverflowError):
        report.add(NumberTooLarge(number.span, type=found))


def _check_element(program: Program, target: ast.Reference, report: Report) -> None:
    """Check the indexes of an element of a variable that is written."""
    variable = program.bindings.get(target)
    if not isinstance(variable, ast.Variable) or target in program.poisoned:
        return
    whole = program.types.get(variable, UNKNOWN)
    for index in target.indexes:
        _check_index(program, index, whole, report)
        whole = whole.element if isinstance(whole, ArrayType) else UNKNOWN


def _check_index(program: Program, index: ast.Expression, whole: Type, report: Report) -> None:
    if not isinstance(whole, ArrayType) or whole.size is None or index in program.poisoned:
        return
    value = evaluate(program, index, {}, Report())
    if isinstance(value, int) and not 0 <= value < whole.size:
        report.add(IndexOutOfRange(index.span, index=value, size=whole.size))
