"""A program as one class: all processes are taken into the outermost one, where they still run in parallel."""

from __future__ import annotations

from collections import Counter
from typing import Any

from cspdiag.base.record import replaced
from cspdiag.network.checks.unwritten import may_be_unwritten
from cspdiag.network.ir.actions import Action, InputRead, ReadInputs, RunInstance
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expressions import SignalValue, VariableValue
from cspdiag.network.ir.network import LocalChannel, Network, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import instances_run, parts
from cspdiag.optimize.changes import with_inner_actions
from cspdiag.optimize.flatten.moved import EndNumbers, MovedUp
from cspdiag.optimize.flatten.processes import creation_with
from cspdiag.optimize.fuse.code import NotStaticError
from cspdiag.optimize.variables import with_assignments

MOST_INSTANCES = 64
"""Processes that are taken in at most; following more would take long."""


def opened(network: Network) -> ProcessClass:
    """The outermost process with all others taken into it. Raises NotStaticError where that cannot be done."""
    if len(network.instances) > MOST_INSTANCES:
        raise NotStaticError(f"there are more than {MOST_INSTANCES} processes")
    classes = {entry.name: entry for entry in network.classes}
    entry = classes[network.top]
    assert isinstance(entry, ProcessClass)
    if entry.body is None:
        raise NotStaticError(f"{entry.name} is written by hand")
    while entry.instances:
        entry = _opened_once(entry, entry.body, classes)
    unwritten = may_be_unwritten(replaced(network, classes=(entry,)))[entry.name]
    if unwritten:
        raise NotStaticError(f"{min(unwritten)} may be read before it is written")
    return _with_variables(entry)


def _opened_once(entry: ProcessClass, body: Action | None, classes: dict[str, Any]) -> ProcessClass:
    assert body is not None
    runs = Counter(instances_run(body))
    numbers = EndNumbers(entry)
    moved: dict[str, MovedUp] = {}
    for instance in entry.instances:
        inner = classes[instance.class_name]
        if isinstance(inner, SubmodelClass) or inner.body is None:
            raise NotStaticError(f"{instance.name} is written by hand", instance.span)
        if runs[instance.name] != 1:
            raise NotStaticError(f"{instance.name} is not run at one place", instance.span)
        moved[instance.name] = MovedUp(instance, inner, entry, numbers, classes)

    def change(action: Action) -> Action:
        if isinstance(action, RunInstance):
            return moved[action.instance].scope(action)
        return with_inner_actions(action, change)

    parts_in = moved.values()
    return with_assignments(
        replaced(
            entry,
            channels=(*entry.channels, *(channel for part in parts_in for channel in part.channels)),
            instances=tuple(instance for part in parts_in for instance in part.instances),
            constants=(*entry.constants, *(constant for part in parts_in for constant in part.constants)),
            states=(*entry.states, *(state for part in parts_in for state in part.states)),
            creation=tuple(creation_with(entry, moved)),
            body=change(body),
        )
    )


def _with_variables(entry: ProcessClass) -> ProcessClass:
    """The inputs of control laws as variables: they are read at different times."""
    reads = {read.name: read for part in parts(entry.body) if isinstance(part, ReadInputs) for read in part.reads}
    if any(channel.name in reads for channel in entry.channels):
        raise NotStaticError("an input of a control law has the name of a channel")

    def change(item: Any) -> Any:
        if isinstance(item, SignalValue) and item.name in reads:
            return VariableValue(type=item.type, span=item.span, channel=item.name)
        return item

    made = tuple(_variable(read, entry) for read in reads.values())
    return replaced(entry, body=rewritten(entry.body, change), channels=(*entry.channels, *made))


def _variable(read: InputRead, entry: ProcessClass) -> LocalChannel:
    return LocalChannel(name=read.name, span=entry.span, type=read.type, kind="var")
