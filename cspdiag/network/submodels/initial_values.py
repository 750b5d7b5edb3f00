"""Initial values that follow parameters of the program: known for the beginning of a run, but not for a reset."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from cspdiag.base import Diagnostic, Report, Span
from cspdiag.base.record import replaced
from cspdiag.model.constants.arithmetic import OutOfRangeError, UndefinedError
from cspdiag.model.diagnostics.constants import ConstantDivision, ConstantOverflow, IndexOutOfRange
from cspdiag.network.elaborate.constant_value import Lookup, NoElementError, NoValueError, computed_value
from cspdiag.network.elaborate.finite import assured
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import Expression, LiteralValue, ParameterValue, SignalValue, TunableValue, Value
from cspdiag.network.ir.network import CoreClass, Environment, Instantiation, ProgramParameter, SubmodelClass


def with_tested_initial_values(entry: CoreClass | SubmodelClass) -> CoreClass | SubmodelClass:
    """The class with tests, if it is a law, of the initial values that a reset computes from parameters of the program:
    one that is infinite or not a number is a fault, as every value that a state gets.
    """
    if not isinstance(entry, SubmodelClass):
        return entry
    states = tuple(
        replaced(state, initial=assured(state.initial)) if _follows(state.initial) else state for state in entry.states
    )
    return replaced(entry, states=states)


def check_initial_values(
    classes: Mapping[str, CoreClass | SubmodelClass],
    instances: Iterable[Instantiation],
    environments: Iterable[Environment],
    parameters: Iterable[ProgramParameter],
    report: Report,
) -> None:
    """Report initial values of variables and states that cannot be computed from what the parameters of the program are
    at the beginning of a run.
    """
    found: set[tuple[Span, str]] = set()
    for item in instances:
        entry = classes[item.class_name]
        constants = entry.constants if isinstance(entry, SubmodelClass) else ()
        _check(_initial_values(entry), constants, dict(item.arguments), report, found)
    values = {parameter.name: parameter.value for parameter in parameters}
    for environment in environments:
        if environment.system is not None:
            _check(_initial_values(environment.system), environment.system.constants, values, report, found)


def _follows(expression: Expression) -> bool:
    return any(isinstance(part, TunableValue) for part in walk(expression))


def _initial_values(entry: CoreClass | SubmodelClass) -> Iterator[tuple[Expression, Span]]:
    items = entry.states if isinstance(entry, SubmodelClass) else entry.channels
    for item in items:
        if item.initial is not None and _follows(item.initial):
            yield item.initial, item.initial.span or item.span


def _check(
    initial_values: Iterable[tuple[Expression, Span]],
    constants: Sequence[SubmodelEquation],
    values: Mapping[str, Value],
    report: Report,
    found: set[tuple[Span, str]],
) -> None:
    equations = {item.name: item.value for item in constants}

    def known(part: Any) -> Any:
        if isinstance(part, ParameterValue | TunableValue) and part.name in values:
            return LiteralValue(type=part.type, value=values[part.name])
        return part

    def lookup(part: ParameterValue | SignalValue) -> Value | None:
        value = equations.get(part.name)
        return None if value is None else computed_value(rewritten(value, known), lookup)

    for expression, span in initial_values:
        problem = _problem(rewritten(expression, known), lookup, span)
        if problem is not None and (span, problem.message) not in found:
            found.add((span, problem.message))
            report.add(problem)


def _problem(expression: Expression, lookup: Lookup, span: Span) -> Diagnostic | None:
    try:
        computed_value(expression, lookup)
    except NoValueError:
        return None
    except NoElementError as problem:
        return IndexOutOfRange(span, index=problem.index, size=problem.size)
    except UndefinedError as problem:
        return ConstantDivision(span, problem=str(problem))
    except OutOfRangeError as problem:
        return ConstantOverflow(span, value=problem.shown, type=expression.type)
    return None
