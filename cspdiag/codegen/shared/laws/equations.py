"""Dependencies between the signals of a submodel."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from cspdiag.base.record import replaced
from cspdiag.model.types import RealType, Type
from cspdiag.network.ir.actions import RunLaw
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.expressions import (
    Expression,
    FunctionCall,
    ParameterValue,
    PresentTime,
    SignalValue,
    TunableValue,
)
from cspdiag.network.ir.network import ProcessClass, SubmodelClass, SubmodelState
from cspdiag.network.ir.walk import parts

Equation = SubmodelEquation | ExternalCall


def signals(items: Iterable[object]) -> Counter[str]:
    """How often expressions read each signal."""
    return Counter(part.name for part in parts(tuple(items)) if isinstance(part, SignalValue))


def parameters(items: Iterable[object]) -> Counter[str]:
    """How often expressions read each parameter."""
    return Counter(part.name for part in parts(tuple(items)) if isinstance(part, ParameterValue | TunableValue))


def uses_time(items: Iterable[object]) -> bool:
    """Whether expressions read the present instant."""
    return any(isinstance(part, PresentTime) for part in parts(tuple(items)))


def values(equation: Equation) -> tuple[Expression, ...]:
    """The expressions that an equation evaluates."""
    if isinstance(equation, ExternalCall):
        return tuple(value for _, value in equation.inputs)
    return (equation.value,)


def defined(equation: Equation) -> tuple[str, ...]:
    """The signals that an equation defines."""
    if isinstance(equation, ExternalCall):
        return tuple(local for _, local, _ in equation.outputs)
    return (equation.name,)


def finite_signals(equations: Iterable[Equation]) -> frozenset[str]:
    """The signals that are tested for being finite wherever they are computed."""
    tested: set[str] = set()
    others: set[str] = set()
    for equation in equations:
        known = isinstance(equation, SubmodelEquation) and is_tested(equation.value)
        (tested if known else others).update(defined(equation))
    return frozenset(tested - others)


def is_tested(value: Expression) -> bool:
    """Whether evaluating a real number is a fault if it is not finite."""
    return isinstance(value, FunctionCall) and value.function == "finite" and isinstance(value.type, RealType)


def needed(equations: Sequence[Equation], roots: Iterable[str], *, calls: bool = True) -> list[Equation]:
    """The equations on which ``roots`` depend, in order; with ``calls`` also all external calls."""
    wanted = set(roots)
    kept: list[Equation] = []
    for equation in reversed(equations):
        is_call = isinstance(equation, ExternalCall)
        if is_call and not calls:
            continue
        if is_call or not wanted.isdisjoint(defined(equation)):
            kept.append(equation)
            wanted.update(signals(values(equation)))
    return kept[::-1]


def outputs(class_: SubmodelClass) -> list[str]:
    """The output ports, in order."""
    return [port.name for port in class_.ports if port.direction == "out"]


def inputs(class_: SubmodelClass) -> list[str]:
    """The input ports, in order."""
    return [port.name for port in class_.ports if port.direction == "in"]


def held(class_: SubmodelClass) -> list[str]:
    """What the derivatives read that is constant within a sample: inputs, other equations, discrete states."""
    moving = {equation.name for equation in class_.derivative_equations}
    moving |= {state.name for state in class_.states if state.continuous}
    moving |= {constant.name for constant in class_.constants}
    read = signals((class_.derivatives, *(equation.value for equation in class_.derivative_equations)))
    return [name for name in read if name not in moving]


def evaluated_in_stages(class_: SubmodelClass) -> SubmodelClass:
    """The class without the states that move by a matrix: the others are integrated by evaluating their derivatives."""
    linear = {name for block in class_.linear for name in block.states}
    if not linear:
        return class_
    derivatives = tuple(item for item in class_.derivatives if item[0] not in linear)
    equations = needed(class_.derivative_equations, signals((derivatives,)))
    return replaced(
        class_,
        states=tuple(state for state in class_.states if state.name not in linear),
        derivative_equations=tuple(item for item in equations if isinstance(item, SubmodelEquation)),
        derivatives=derivatives,
        linear=(),
    )


def changes(class_: ProcessClass | SubmodelClass, run: RunLaw | None = None) -> dict[str, SubmodelState]:
    """The states by name, each at the place where its next value or derivative is given; with ``run`` only those that
    an inlined law changes.
    """
    changed = None if run is None else {name for name, _ in (*run.next_values, *run.derivatives)}
    return {
        state.name: replaced(state, span=state.change or state.span)
        for state in class_.states
        if changed is None or state.name in changed
    }


def read_after_change(next_values: Iterable[tuple[str, Expression]]) -> dict[str, int]:
    """The states that are read after they have been given their next values, in the order of reading, and how often."""
    late: Counter[str] = Counter()
    changed: set[str] = set()
    for name, value in next_values:
        late.update(signal for signal in signals((value,)) if signal in changed)
        changed.add(name)
    return late


def evaluated_in_runs(class_: SubmodelClass) -> tuple[object, ...]:
    """The expressions that a law evaluates after construction: at a reset, and in each run."""
    return (
        tuple(state.initial for state in class_.states),
        class_.next_values,
        class_.derivatives,
        tuple(equation.value for equation in class_.derivative_equations),
        tuple(part for equation in class_.equations for part in values(equation)),
    )


def constants_needed(class_: SubmodelClass) -> list[SubmodelEquation]:
    """The constants on which anything depends."""
    roots = signals(
        (
            class_.states,
            class_.next_values,
            class_.derivatives,
            class_.derivative_equations,
            tuple(part for equation in class_.equations for part in values(equation)),
            tuple(equation.arguments for equation in class_.equations if isinstance(equation, ExternalCall)),
        )
    )
    return [item for item in needed(class_.constants, roots) if isinstance(item, SubmodelEquation)]


def signal_types(class_: SubmodelClass) -> dict[str, Type]:
    """The type of everything with a value in a submodel, by name."""
    types: dict[str, Type] = {}
    for group in (class_.parameters, class_.ports, class_.states, class_.constants):
        types.update((item.name, item.type) for item in group)
    held = [item for block in class_.linear for item in block.equations]
    for equation in (*class_.equations, *class_.derivative_equations, *held):
        if isinstance(equation, ExternalCall):
            types.update({local: type_ for _, local, type_ in equation.outputs})
        else:
            types[equation.name] = equation.type
    return types
