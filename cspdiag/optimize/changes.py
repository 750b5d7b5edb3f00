"""Copies of actions with changes inside them; whatever does not change stays the same object."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from operator import is_
from typing import TypeVar, assert_never

from cspdiag.base.record import field_names, is_record, replaced
from cspdiag.network.ir import actions as ir

T = TypeVar("T")

_UNCHANGED_FIELDS = frozenset({"span", "type", "doc"})


def with_inner_actions(action: ir.Action, change: Callable[[ir.Action], ir.Action]) -> ir.Action:
    """The action with each action directly inside it changed, in text order."""
    match action:
        case ir.RunInstance():  # First, because that is what large networks have most of.
            return action
        case ir.SequentialSteps() | ir.ParallelSteps():
            return changed(action, steps=mapped(action.steps, change))
        case ir.Choice():
            return changed(action, branches=mapped(action.branches, lambda branch: _branch(branch, change)))
        case ir.Repeat() | ir.WhileLoop() | ir.CountedLoop() | ir.Group() | ir.ProcessScope():
            return changed(action, body=change(action.body))
        case ir.IfElse():
            return changed(action, then=change(action.then), otherwise=change(action.otherwise))
        case ir.CatchException():
            return changed(action, body=change(action.body), handler=change(action.handler))
        case ir.InterruptOn():
            return changed(action, body=change(action.body), branch=_branch(action.branch, change))
        case (
            ir.ReadValue() | ir.WriteValue() | ir.AssignValue() | ir.SkipStep() | ir.StopStep() | ir.WaitStep()
            | ir.ResetInstance() | ir.RaiseException() | ir.ReadInputs() | ir.WriteOutputs() | ir.RunLaw()
            | ir.ResetStates() | ir.ReportCommunication()
        ):  # fmt: skip
            return action
        case _:
            assert_never(action)


def _branch(branch: ir.Branch, change: Callable[[ir.Action], ir.Action]) -> ir.Branch:
    return changed(branch, body=change(branch.body))


def rebuilt(action: ir.Action, change: Callable[[ir.Action], ir.Action]) -> ir.Action:
    """The action with every action in it changed, innermost first; sequences directly inside sequences are joined."""
    inside = with_inner_actions(action, lambda inner: rebuilt(inner, change))
    if inside is not action and isinstance(inside, ir.SequentialSteps):
        inside = in_sequence(inside.steps, inside)
    return change(inside)


def in_sequence(steps: Iterable[ir.Action], like: ir.Action) -> ir.Action:
    """The steps as one sequence with nested sequences joined and skips removed; it has the source place of ``like``."""
    flat: list[ir.Action] = []
    for step in steps:
        if isinstance(step, ir.SequentialSteps):
            flat.extend(step.steps)
        elif not isinstance(step, ir.SkipStep):
            flat.append(step)
    if not flat:
        return ir.SkipStep(span=like.span)
    return flat[0] if len(flat) == 1 else ir.SequentialSteps(span=like.span, steps=tuple(flat))


def with_parts(item: T, change: Callable[[object], object | None]) -> T:
    """A record, or a tuple of records, with the parts replaced for which ``change`` returns a value; these are not
    searched further.
    """

    def inner(part: object) -> object:
        if isinstance(part, tuple):
            items = [inner(element) for element in part]
            same = all(old is new for old, new in zip(part, items, strict=True))
            return part if same else tuple(items)
        if not is_record(part):
            return part
        replacement = change(part)
        if replacement is not None:
            return replacement
        changes = {}
        for name in field_names(part):
            if name not in _UNCHANGED_FIELDS:
                old = getattr(part, name)
                new = inner(old)
                if new is not old:
                    changes[name] = new
        return replaced(part, **changes) if changes else part

    return inner(item)  # type: ignore[return-value]


def changed(item: T, **fields: object) -> T:
    """A record with these fields; the same object if they are already what it has."""
    for name, value in fields.items():
        if getattr(item, name) is not value:
            return replaced(item, **fields)
    return item


def mapped(items: tuple[T, ...], change: Callable[[T], T]) -> tuple[T, ...]:
    """The items changed; the same tuple if none is."""
    results = tuple(map(change, items))
    return items if all(map(is_, items, results)) else results
