"""Reads the variable that a value comes from instead of a copy of it, so that copies which a rendezvous left become needless.

A copy stands for its origin until one of the two is written again. Where ways meet, what holds on all of them holds; at the start of a loop, what holds before
it and still, or again, at its end.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from cspdiag.base.record import replaced
from cspdiag.model.types import BOOL
from cspdiag.network.flow.ends import may_end
from cspdiag.network.ir.actions import (
    Action,
    AssignValue,
    ChannelEnd,
    Choice,
    CountedLoop,
    Group,
    IfElse,
    ProcessScope,
    Repeat,
    SequentialSteps,
    Target,
    WhileLoop,
    WriteValue,
)
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expressions import LiteralValue, VariableValue
from cspdiag.network.ir.walk import parts
from cspdiag.optimize.changes import with_inner_actions

T = TypeVar("T")
Copies = Mapping[str, str]
"""The variable whose value each copy has."""

NOTHING: Copies = {}


def without_copies(body: Action) -> Action:
    """The composition of one process without parallels, reading origins instead of copies; the copies are still made."""
    return _after(body, NOTHING)[0]


def _after(action: Action, copies: Copies) -> tuple[Action, Copies | None]:
    """The action where these copies hold, and the copies that hold after it; None where it never ends."""
    match action:
        case SequentialSteps():
            steps = []
            known: Copies | None = copies
            for step in action.steps:
                step, known = _after(step, NOTHING if known is None else known)
                steps.append(step)
            return replaced(action, steps=tuple(steps)), known
        case AssignValue(target=target) if not target.indexes:
            value = _origins(action.value, copies)
            after = _written(copies, {target.channel})
            if isinstance(value, VariableValue) and value.channel != target.channel:
                after = {**after, target.channel: value.channel}
            return replaced(action, value=value), after
        case IfElse():
            condition = _origins(action.condition, copies)
            then, one = _after(action.then, copies)
            otherwise, other = _after(action.otherwise, copies)
            return replaced(action, condition=condition, then=then, otherwise=otherwise), _both(one, other)
        case Repeat():
            return _repeated(action, copies)
        case CountedLoop():
            return _turns(action, copies)
        case WhileLoop():
            return _while(action, copies)
        case Group() | ProcessScope():
            body, after_body = _after(action.body, copies)
            return replaced(action, body=body), after_body
        case Choice():
            known = _written(copies, _targets(action))
            return with_inner_actions(action, lambda inner: _after(inner, known)[0]), known
        case _:
            after = _written(copies, _targets(action))
            return _origins(action, copies), after if may_end(action) else None


def _repeated(loop: Repeat, copies: Copies) -> tuple[Action, Copies | None]:
    entry = copies
    while True:
        body, after = _after(loop.body, entry)
        again = _both(entry, after)
        if again == entry or after is None:
            break
        assert again is not None
        entry = again
    until = loop.until if loop.until is None else _origins(loop.until, after or NOTHING)
    return replaced(loop, body=body, until=until), None if loop.until is None else after


def _turns(loop: CountedLoop, copies: Copies) -> tuple[Action, Copies | None]:
    once = Repeat(span=loop.span, body=loop.body, until=LiteralValue(type=BOOL, value=False))
    repeated, after = _repeated(once, copies)
    assert isinstance(repeated, Repeat)
    return replaced(loop, body=repeated.body), after


def _while(loop: WhileLoop, copies: Copies) -> tuple[Action, Copies | None]:
    entry = copies
    while True:
        body, after = _after(loop.body, entry)
        again = _both(entry, after)
        if again == entry or after is None:
            break
        assert again is not None
        entry = again
    return replaced(loop, body=body, condition=_origins(loop.condition, entry)), entry


def _both(one: Copies | None, other: Copies | None) -> Copies | None:
    if one is None or other is None:
        return other if one is None else one
    return {name: origin for name, origin in one.items() if other.get(name) == origin}


def _written(copies: Copies, names: set[str]) -> Copies:
    return {name: origin for name, origin in copies.items() if name not in names and origin not in names}


def _targets(item: object) -> set[str]:
    """The variables that an action may write."""
    found = set()
    for part in parts(item):
        match part:
            case Target(channel=channel) | WriteValue(sink=ChannelEnd(channel=channel)):
                found.add(channel)
            case _:
                pass
    return found


def _origins(item: T, copies: Copies) -> T:
    def change(part: Any) -> Any:
        if isinstance(part, VariableValue) and part.channel in copies:
            return replaced(part, channel=copies[part.channel])
        return part

    return rewritten(item, change) if copies else item
