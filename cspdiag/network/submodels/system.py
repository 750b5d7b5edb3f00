"""Makes a system from a draft: sorts its equations, separates constants, discretizes it, and selects the equations that
integration needs.
"""

from __future__ import annotations

from typing import Any, Literal

from cspdiag.base import Report
from cspdiag.base.record import replaced
from cspdiag.network.diagnostics.operators import UnstableDiscretization, WrongShape
from cspdiag.network.diagnostics.submodels import AlgebraicLoop
from cspdiag.network.elaborate.finite import assured_law, is_defined_everywhere, within_domains
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expression_walk import signals_read, walk
from cspdiag.network.ir.expressions import Expression, PresentTime, SignalValue, TunableValue, Value
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import SubmodelClass
from cspdiag.network.submodels.discretize import Method, spectral_radius, statespace_increments, transfer_coefficients
from cspdiag.network.submodels.draft import Draft, LinearOperator
from cspdiag.network.submodels.equation_order import Item, ordered, provides
from cspdiag.network.submodels.linear import linear_blocks
from cspdiag.network.submodels.next_values import computed_first, output_signals
from cspdiag.network.submodels.vector_states import split_vector_states


def evaluation_order(draft: Draft, report: Report) -> tuple[Item, ...] | None:
    """The equations of a draft, each after those that it reads; None if there are loops, which are reported."""
    order = ordered(list(draft.equations.values()))
    for loop in order.loops:
        report.add(_shown(loop, draft))
    return None if order.loops else order.items


def complete(system: SubmodelClass, draft: Draft, report: Report) -> SubmodelClass | None:
    """The class ``system`` with the equations of the draft added.

    None if there are algebraic loops or impossible coefficients, which are reported.
    """
    outputs = output_signals(system)
    split_vector_states(draft)
    items = evaluation_order(draft, report)
    if items is None or not draft.complete:
        return None
    _discretize(draft, report)
    # Discretization gives values to constants of a closed system.
    items = tuple(draft.equations[item.name] for item in items)
    constants, equations = _constants_apart(draft, items, outputs)
    _compute_initial_values(draft, {item.name for item in constants})
    kept = _alive(draft, constants, equations, outputs)
    constants = tuple(item for item in constants if item.name in kept)
    plain = tuple(item for item in equations if not kept.isdisjoint(provides(item)))
    untested = [item.name for item in constants if draft.probed(item.value) is None]
    equations, following = assured_law(plain, draft.next_values, outputs, untested)
    moving = [replaced(item, value=within_domains(item.value)) for item in _while_integrating(draft, plain)]
    slopes = {name: within_domains(draft.derivatives[name]) for name in draft.states if name in draft.derivatives}
    states = tuple(replaced(state, change=draft.changes.get(name)) for name, state in draft.states.items())
    next_values = tuple((state.name, following[state.name]) for state in states if state.name in following)
    if not draft.closed:
        equations, next_values = computed_first(equations, next_values, states, draft.unique)
    method: Literal["rk4", "euler"] = "euler" if draft.methods and set(draft.methods) == {"euler"} else "rk4"
    return replaced(
        system,
        parameters=tuple(draft.parameters.values()),
        constants=constants,
        states=states,
        equations=equations,
        next_values=next_values,
        derivative_equations=tuple(moving),
        derivatives=tuple(slopes.items()),
        linear=linear_blocks(draft, moving, slopes) if method == "rk4" else (),
        method=method,
        step=min(draft.steps, default=None),
        decisive=_decisive(draft, constants) if draft.closed else (),
    )


def _decisive(draft: Draft, constants: tuple[SubmodelEquation, ...]) -> tuple[str, ...]:
    """The constants whose values have become a part of the system, directly or by way of others; bodies in other
    languages are given their arguments once.
    """
    given = (
        value for item in draft.equations.values() if isinstance(item, ExternalCall) for _, value in item.arguments
    )
    decisive = {*draft.decisive, *(name for value in given for name in signals_read(value))}
    pending = list(decisive)
    while pending:
        equation = draft.equations.get(pending.pop())
        more = set(equation.reads) - decisive if isinstance(equation, SubmodelEquation) else set[str]()
        decisive |= more
        pending.extend(more)
    return tuple(item.name for item in constants if item.name in decisive)


def _shown(loop: tuple[Item, ...], draft: Draft) -> AlgebraicLoop:
    """The diagnostic of a loop, from the outermost of its equations on; signals that the compiler has named are shown
    by their text.
    """
    start = min(range(len(loop)), key=lambda index: loop[index].name.count("."))
    turned = loop[start:] + loop[:start]
    places = tuple((draft.written.get(item.name, item.name), item.span) for item in turned)
    return AlgebraicLoop(turned[0].span, places, in_environment=draft.closed)


def _constants_apart(
    draft: Draft, items: tuple[Item, ...], outputs: frozenset[str]
) -> tuple[tuple[SubmodelEquation, ...], tuple[Item, ...]]:
    """The equations over parameters only, which become constants, and the others.

    An output is not made a constant, since it is written at every sample; nor is an equation that faults, since it does
    so in each run of the law, and not before the first.
    """
    constants: list[SubmodelEquation] = []
    known: set[str] = set()
    equations: list[Item] = []
    for item in items:
        if (
            isinstance(item, SubmodelEquation)
            and item.name not in outputs
            and known.issuperset(item.reads)
            and not _varies(item.value)
            and not _faults(draft, item.value)
        ):
            constants.append(item)
            known.add(item.name)
        else:
            equations.append(item)
    return tuple(constants), tuple(equations)


def _compute_initial_values(draft: Draft, constants: set[str]) -> None:
    """Replaces what follows parameters of the program in initial values of states by the expressions that it stands
    for: it is an equation now, and those are not evaluated before the first run.
    """

    def change(part: Any) -> Any:
        if not isinstance(part, SignalValue) or part.name in constants:
            return part
        equation = draft.equations.get(part.name)
        return rewritten(equation.value, change) if isinstance(equation, SubmodelEquation) else part

    for name, state in draft.states.items():
        if not constants.issuperset(signals_read(state.initial)):
            draft.states[name] = replaced(state, initial=rewritten(state.initial, change))


def _faults(draft: Draft, expression: Expression) -> bool:
    """Whether the evaluation of an expression over parameters ends in a fault."""
    return (may_fault(expression) or not is_defined_everywhere(expression)) and draft.probed(expression) is None


def _reads_time(expression: Expression) -> bool:
    return any(isinstance(part, PresentTime) for part in walk(expression))


def _varies(expression: Expression) -> bool:
    """Whether an expression without signals may have another value at another instant."""
    return any(isinstance(part, PresentTime | TunableValue) for part in walk(expression))


def _alive(
    draft: Draft, constants: tuple[SubmodelEquation, ...], equations: tuple[Item, ...], outputs: frozenset[str]
) -> set[str]:
    """The signals to compute: those that outputs and states need, and those of the submodel itself (without a dot in
    their names) that cannot fault.

    Other signals need not be computed.
    """
    alive = set(outputs)
    for expression in (*draft.next_values.values(), *draft.derivatives.values()):
        alive.update(signals_read(expression))
    for state in draft.states.values():
        alive.update(signals_read(state.initial))
    sound = _sound(draft, (*constants, *equations))
    for item in reversed((*constants, *equations)):
        names = provides(item)
        own = draft.kept if draft.closed else {name for name in names if "." not in name and name in sound}
        if not alive.isdisjoint(names) or not own.isdisjoint(names):
            alive.update(names)
            alive.update(item.reads)
    return alive


def _sound(draft: Draft, items: tuple[Item, ...]) -> set[str]:
    """The signals that can be computed without a fault, including everything that they need."""
    faulty: set[str] = set()
    for item in items:
        values = [item.value] if isinstance(item, SubmodelEquation) else [value for _, value in item.inputs]
        if not faulty.isdisjoint(item.reads) or any(_faults(draft, value) for value in values):
            faulty.update(provides(item))
    return {name for item in items for name in provides(item)} - faulty


def _while_integrating(draft: Draft, equations: tuple[Item, ...]) -> tuple[SubmodelEquation, ...]:
    """The equations that must be evaluated again in every sub-step of an integration.

    They depend on continuous states or on the time; outputs of discrete operators and of external calls are held over
    the sample.
    """
    varying = set(draft.derivatives)
    again: list[SubmodelEquation] = []
    for item in equations:
        if isinstance(item, ExternalCall) or item.name in draft.held:
            continue
        if not varying.isdisjoint(item.reads) or _reads_time(item.value):
            varying.add(item.name)
            again.append(item)
    needed = {name for expression in draft.derivatives.values() for name in signals_read(expression)}
    for item in reversed(again):
        if item.name in needed:
            needed.update(item.reads)
    return tuple(item for item in again if item.name in needed)


def _discretize(draft: Draft, report: Report) -> None:
    """Computes the coefficients of transfer functions and state spaces."""
    for operator in draft.linear_operators:
        if draft.sample is None:
            continue
        matrices = [draft.value_of(matrix) for matrix in operator.matrices]
        values = _coefficients(draft, operator, matrices, draft.sample / 1_000_000_000, report)
        if values is None:
            draft.complete = False
            continue
        for (name, kind), value in zip(operator.coefficients, values, strict=True):
            draft.give(name, kind, value)


def _coefficients(
    draft: Draft, operator: LinearOperator, matrices: list[Value | None], sample: float, report: Report
) -> list[Value] | None:
    method: Method = operator.method
    try:
        if len(matrices) == 4:
            a, b, c, d = (_rows(matrix) for matrix in matrices)
            return list(statespace_increments(a, b, c, d, method, sample))
        numerator, denominator = (_row(matrix) for matrix in matrices)
        if denominator[0] == 0:
            report.add(WrongShape(operator.span, "the first coefficient of the denominator is zero"))
            return None
        above, below = transfer_coefficients(numerator, denominator, method, sample)
    except (ValueError, ArithmeticError):
        report.add(WrongShape(operator.span, "these coefficients have no discretization at this sample period"))
        return None
    if method == "euler":
        _warn_if_unstable(operator, denominator, sample, report)
    coefficients: list[Value] = [*above, *below]
    return coefficients[len(coefficients) - len(operator.coefficients) :]


def _row(value: Value | None) -> list[float]:
    if not isinstance(value, tuple):
        raise ValueError
    return [float(element) for element in value if isinstance(element, int | float)]


def _rows(value: Value | None) -> list[list[float]]:
    if not isinstance(value, tuple):
        raise ValueError
    return [_row(row) for row in value]


def _warn_if_unstable(operator: LinearOperator, denominator: list[float], sample: float, report: Report) -> None:
    stable, radius = spectral_radius(denominator, sample)
    if stable and radius > 1:
        report.add(UnstableDiscretization(operator.span, f"{sample * 1000:g} ms", radius))
