"""What a run of a law computes before any state changes: its outputs, and the next values that are equations."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from cspdiag.base import Span
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.expression_walk import signals_read
from cspdiag.network.ir.expressions import Expression, SignalValue
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import SubmodelClass, SubmodelState

NextValues = tuple[tuple[str, Expression], ...]


def computed_first(
    equations: Iterable[SubmodelEquation | ExternalCall],
    next_values: NextValues,
    states: Iterable[SubmodelState],
    unique: Callable[[str], str],
) -> tuple[tuple[SubmodelEquation | ExternalCall, ...], NextValues]:
    """The equations and next values of a law, where next values that may fault, or that read continuous states, become
    equations; ``unique`` makes their names.
    """
    of_name = {state.name: state for state in states}
    continuous = {state.name for state in of_name.values() if state.continuous}
    computed = list(equations)
    made: list[tuple[str, Expression]] = []
    for name, value in next_values:
        if may_fault(value) or not continuous.isdisjoint(signals_read(value)):
            state = of_name[name]
            local = unique(f"{name}_next")
            computed.append(SubmodelEquation(name=local, type=state.type, value=value, span=place_of_next(state)))
            value = SignalValue(type=state.type, name=local)
        made.append((name, value))
    return tuple(computed), tuple(made)


def place_of_next(state: SubmodelState) -> Span:
    """Where the next value of a state is given."""
    return state.change or state.span


def output_signals(law: SubmodelClass) -> frozenset[str]:
    """The names of the signals that are outputs of a law, for arrays of ports those of their elements."""
    return frozenset(
        port.name if port.size is None else f"{port.name}[{index}]"
        for port in law.ports
        for index in range(1 if port.size is None else port.size)
        if port.direction == "out"
    )
