"""Copy propagation: reads the origin of a value instead of a copy, so copies that rendezvous have left become dead.

A copy equals its origin until one of the two is written again. Where paths join, a copy is known only if it is known on
all of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from cspdiag.base.record import replaced
from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import SINGLE_STEPS, Communicate, Compute, Delay, Instruction, Test
from cspdiag.network.flow.dataflow import solve
from cspdiag.network.flow.effects import writes
from cspdiag.network.ir.actions import Action, AssignValue, ChannelEnd, IfElse, Repeat, Target, WhileLoop
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expressions import VariableValue
from cspdiag.optimize.changes import changed, with_inner_actions

T = TypeVar("T")
Copies = Mapping[str, str]
"""The variable whose value each copy has."""

NOTHING: Copies = {}


def without_copies(body: Action) -> Action:
    """The composition of one process without parallels and instances, with reads of origins instead of copies; the
    copies are still made.
    """
    code = flow_of(body)
    states = solve(code, NOTHING, _after, _on_all_paths)
    # The steps and conditions in text order, as the walk below visits them; no copies are known in unreachable ones.
    known = iter(
        [
            copies or NOTHING
            for instruction, copies in zip(code.instructions, states, strict=True)
            if isinstance(instruction, Compute | Communicate | Delay | Test)
        ]
    )

    def reading_origins(action: Action) -> Action:
        if isinstance(action, SINGLE_STEPS):
            return _origins(action, next(known))
        if isinstance(action, IfElse | WhileLoop):
            action = changed(action, condition=_origins(action.condition, next(known)))
        action = with_inner_actions(action, reading_origins)
        if isinstance(action, Repeat) and action.until is not None:
            action = changed(action, until=_origins(action.until, next(known)))
        return action

    return reading_origins(body)


def _after(index: int, instruction: Instruction, copies: Copies) -> Copies:
    written = {place.channel for place in writes(instruction) if isinstance(place, Target | ChannelEnd)}
    if not written:
        return copies
    after = {name: origin for name, origin in copies.items() if name not in written and origin not in written}
    match instruction:
        case Compute(step=AssignValue(target=Target(channel=name, indexes=()), value=VariableValue(channel=source))):
            origin = copies.get(source, source)
            return after if origin == name else {**after, name: origin}
        case _:  # No other instruction makes a copy.
            return after


def _on_all_paths(_: Instruction, paths: list[Copies]) -> Copies:
    first, *others = paths
    return {name: origin for name, origin in first.items() if all(other.get(name) == origin for other in others)}


def _origins(item: T, copies: Copies) -> T:
    def change(part: Any) -> Any:
        if isinstance(part, VariableValue) and part.channel in copies:
            return replaced(part, channel=copies[part.channel])
        return part

    return rewritten(item, change) if copies else item
