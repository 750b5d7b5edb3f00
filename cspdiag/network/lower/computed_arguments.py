"""Computed arguments in the place of the parameters of a class.

An argument may be infinite, not a number, or a fault where the parameter itself could not be. So the class gets the
tests that it would have if the text had the computation in each of these places.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cspdiag.base.record import replaced
from cspdiag.network.elaborate.finite import assured_law, is_defined_everywhere, stored, within_domains
from cspdiag.network.ir.actions import AssignValue, CoreAction, OutputEvent, WriteValue
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expression_walk import signals_read
from cspdiag.network.ir.expressions import Expression, SignalValue, TunableValue
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import ProcessClass, SubmodelClass
from cspdiag.network.lower.distinct_names import DistinctNames
from cspdiag.network.submodels.equation_order import Item, provides
from cspdiag.network.submodels.next_values import computed_first, output_signals, place_of_next


def process_with_arguments(
    entry: ProcessClass[CoreAction], computed: Mapping[str, Expression]
) -> ProcessClass[CoreAction]:
    """A process with these values of parameters; what it assigns and writes is tested.

    Arguments of its instances are not, since nothing is stored by them.
    """
    values = _within_domains(computed)

    def change(part: Any) -> Any:
        part = _substituted(part, values)
        if isinstance(part, WriteValue | AssignValue | OutputEvent):
            value = stored(part.value)
            return part if value is part.value else replaced(part, value=value)
        return part

    return rewritten(entry, change)


def law_with_arguments(entry: SubmodelClass, computed: Mapping[str, Expression]) -> SubmodelClass:
    """A control law with these values of parameters; its outputs and the next values of its states are tested.

    Next values that may fault now are computed before any state changes, and signals that may fault now are not
    computed any more if nothing needs them.
    """
    values = _within_domains(computed)
    made = rewritten(entry, lambda part: _substituted(part, values))
    same = set(map(id, entry.equations))
    equations = _needed(made, {item.name for item in made.equations if id(item) not in same})
    tested, following = assured_law(equations, dict(made.next_values), output_signals(made) | _next_equations(made))
    names = DistinctNames(names_of_law(made))
    tested, next_values = computed_first(
        tested,
        tuple(following.items()),
        made.states,
        lambda wanted: names.fresh(wanted, lambda number: f"{wanted}_{number}"),
    )
    return replaced(made, equations=tested, next_values=next_values)


def names_of_law(entry: SubmodelClass) -> set[str]:
    """The names that something in a control law has."""
    named = (*entry.parameters, *entry.ports, *entry.constants, *entry.states)
    return {item.name for item in named} | {name for item in entry.equations for name in provides(item)}


def _within_domains(computed: Mapping[str, Expression]) -> dict[str, Expression]:
    return {name: within_domains(value) for name, value in computed.items()}


def _substituted(part: Any, computed: Mapping[str, Expression]) -> Any:
    if isinstance(part, TunableValue) and not part.of_program and part.name in computed:
        return computed[part.name]
    return part


def _next_equations(law: SubmodelClass) -> set[str]:
    """The equations that next values of states have become, which are at their places."""
    places = {item.name: item.span for item in law.equations}
    states = {state.name: state for state in law.states}
    return {
        value.name
        for name, value in law.next_values
        if isinstance(value, SignalValue) and places.get(value.name) == place_of_next(states[name])
    }


def _needed(law: SubmodelClass, changed: set[str]) -> list[Item]:
    """The equations without those that no output and no state depends on and that may fault only by the arguments."""
    faulty: set[str] = set()
    for item in law.equations:
        values = [item.value] if isinstance(item, SubmodelEquation) else [value for _, value in item.inputs]
        is_changed = item.name in changed and any(
            may_fault(value) or not is_defined_everywhere(value) for value in values
        )
        if is_changed or not faulty.isdisjoint(item.reads):
            faulty.update(provides(item))
    needed = set(output_signals(law))
    for _, expression in (*law.next_values, *law.derivatives):
        needed.update(signals_read(expression))
    for state in law.states:
        needed.update(signals_read(state.initial))
    kept = []
    for item in reversed(law.equations):
        names = provides(item)
        if not needed.isdisjoint(names) or faulty.isdisjoint(names):
            needed.update(item.reads)
            kept.append(item)
    return kept[::-1]
