"""Splits continuous states that are arrays into states for their elements, as integration requires."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.base.record import replaced
from cspdiag.model.types import ArrayType, Type
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expression_parts import entry
from cspdiag.network.ir.expressions import ArrayElements, Expression, SignalValue
from cspdiag.network.submodels.draft import Draft


def split_vector_states(draft: Draft) -> None:
    """Replaces the continuous states of a draft that are arrays; their names become equations."""
    for name, state in list(draft.states.items()):
        if name not in draft.derivatives or not isinstance(state.type, ArrayType):
            continue
        slope = draft.derivatives.pop(name)
        del draft.states[name]
        values: dict[str, Expression] = {}
        for suffix, kind, initial, moving in _numbers(state.type, state.initial, slope):
            element = draft.unique(f"{name}{suffix}")
            draft.states[element] = replaced(state, name=element, type=kind, initial=initial)
            draft.derivatives[element] = moving
            draft.changes[element] = draft.changes[name]
            values[suffix] = SignalValue(type=kind, name=element)
        whole = _whole(state.type, "", values)
        draft.equations[name] = SubmodelEquation(
            name=name, type=state.type, value=whole, span=state.span, doc=state.doc
        )


def _numbers(
    kind: Type, initial: Expression, slope: Expression, suffix: str = ""
) -> Iterator[tuple[str, Type, Expression, Expression]]:
    """For each number in a value its suffix, its type, its initial value, and its derivative."""
    if not isinstance(kind, ArrayType):
        yield suffix, kind, initial, slope
        return
    for position in range(kind.size or 0):
        yield from _numbers(kind.element, _part(initial, position), _part(slope, position), f"{suffix}[{position}]")


def _part(whole: Expression, position: int) -> Expression:
    return whole.values[position] if isinstance(whole, ArrayElements) else entry(whole, position)


def _whole(kind: Type, suffix: str, values: dict[str, Expression]) -> Expression:
    if not isinstance(kind, ArrayType):
        return values[suffix]
    parts = tuple(_whole(kind.element, f"{suffix}[{index}]", values) for index in range(kind.size or 0))
    return ArrayElements(type=kind, values=parts)
