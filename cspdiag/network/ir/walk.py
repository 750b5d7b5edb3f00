"""Searches actions and expressions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, TypeVar, assert_never, overload

from cspdiag.base.record import ATOMS, annotations_of, field_names, is_record
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Expression, PresentTime, TunableValue, VariableValue

T = TypeVar("T")


_WITHOUT_RECORDS = ATOMS | {
    "BinaryOperator",
    "ChannelKind",
    "Direction",
    "Function",
    "MediumKind",
    "Value",
    "Value | None",
    "tuple[int, int] | None",
}


def may_have_records(annotation: str) -> bool:
    """Whether a field with this annotation may have records in it, by which it has to be searched."""
    return annotation not in _WITHOUT_RECORDS and not annotation.startswith(("Literal[", "ClassVar["))


def parts(item: object) -> Iterator[object]:
    """Every record in a record, or in a tuple or list of records, itself first, in the order of the text; spans and
    types are left out.
    """
    pending: list[object] = [item]
    while pending:
        part = pending.pop()
        try:
            names = _INSIDE[type(part)]
        except KeyError:
            names = _INSIDE[type(part)] = _names_inside(part)
        if names is not None:
            yield part
            for name in names:
                inner = getattr(part, name)
                if inner is not None:
                    pending.append(inner)
        elif isinstance(part, (tuple, list)):  # A union would be made anew each time.
            pending.extend(reversed(part))


def inner_parts(item: object) -> Sequence[object]:
    """What is directly inside a record or a tuple, the last first, with tuples as they are; spans and types are left
    out.
    """
    if isinstance(item, (tuple, list)):
        return item[::-1]
    kind = type(item)
    if kind not in _INSIDE:
        _INSIDE[kind] = _names_inside(item)
    names = _INSIDE[kind]
    return [getattr(item, name) for name in names] if names is not None else ()


class PartsByType:
    """The parts of an item by type, collected once for several searches."""

    def __init__(self, item: object) -> None:
        self._found: dict[type, list[Any]] = {}
        for part in parts(item):
            self._found.setdefault(type(part), []).append(part)

    def of(self, kind: type[T]) -> Sequence[T]:
        """The parts of exactly this type, in the order of the text."""
        return self._found.get(kind, ())


_INSIDE: dict[type, tuple[str, ...] | None] = {}
"""The fields of a record to search, by type, the last one first; None if it is not a record. Cached, since networks
have millions of parts.
"""


def _names_inside(part: object) -> tuple[str, ...] | None:
    if not is_record(part):
        return None
    kinds = annotations_of(type(part))
    names = (name for name in field_names(part) if name not in ("span", "type") and may_have_records(kinds[name]))
    return tuple(names)[::-1]


@overload
def all_actions(action: ir.CoreAction | None) -> Iterator[ir.CoreAction]: ...
@overload
def all_actions(action: ir.Action | None) -> Iterator[ir.Action]: ...
def all_actions(action: ir.Action | None) -> Iterator[ir.Action]:
    """The action and all actions inside it, in text order: ``parts`` without what is no action. None has none."""
    pending = [] if action is None else [action]
    while pending:
        present = pending.pop()
        yield present
        if type(present) is not ir.RunInstance:
            pending.extend(reversed(actions_inside(present)))


@overload
def actions_inside(action: ir.CoreAction) -> tuple[ir.CoreAction, ...]: ...
@overload
def actions_inside(action: ir.Action) -> tuple[ir.Action, ...]: ...
def actions_inside(action: ir.Action) -> tuple[ir.Action, ...]:
    """The actions directly inside an action, in text order."""
    match action:
        case ir.RunInstance():  # First, because that is what large networks have most of.
            return ()
        case ir.SequentialSteps() | ir.ParallelSteps():
            return action.steps
        case ir.Choice():
            return tuple(branch.body for branch in action.branches)
        case ir.Repeat() | ir.WhileLoop() | ir.CountedLoop() | ir.Group() | ir.ProcessScope():
            return (action.body,)
        case ir.IfElse():
            return (action.then, action.otherwise)
        case ir.CatchException():
            return (action.body, action.handler)
        case ir.InterruptOn():
            return (action.body, action.branch.body)
        case (
            ir.ReadValue() | ir.WriteValue() | ir.AssignValue() | ir.SkipStep() | ir.StopStep()
            | ir.WaitStep() | ir.ResetInstance() | ir.RaiseException() | ir.ReadInputs() | ir.WriteOutputs()
            | ir.RunLaw() | ir.ResetStates() | ir.ReportCommunication()
        ):  # fmt: skip
            return ()
        case _:
            assert_never(action)


def instances_run(action: ir.Action) -> list[str]:
    """The instances that an action runs, in text order."""
    return [part.instance for part in all_actions(action) if isinstance(part, ir.RunInstance)]


def may_change(expression: Expression) -> bool:
    """Whether an expression depends on a variable of the process, on a parameter of the program, or on the present
    instant.
    """
    return any(isinstance(part, VariableValue | TunableValue | PresentTime) for part in parts(expression))


def channels_written(item: object) -> Iterator[str]:
    """The channels of the process, including variables, that anything in a record assigns or writes."""
    for part in parts(item):
        match part:
            case ir.AssignValue(target=target) | ir.ReadValue(target=target) | ir.InputEvent(target=target):
                yield target.channel
            case ir.WriteValue(sink=sink) | ir.OutputEvent(sink=sink) | ir.OutputWrite(sink=sink):
                if isinstance(sink, ir.ChannelEnd):
                    yield sink.channel
            case _:  # Any other part of the composition writes nothing.
                pass
