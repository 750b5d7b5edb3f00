"""A program as one class: all processes are inlined into the outermost one, where they still run in parallel."""

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
from cspdiag.optimize.flatten.inlined import EndNumbers, InlinedProcess
from cspdiag.optimize.flatten.processes import creation_with_inlined
from cspdiag.optimize.fuse.code import NotStaticError
from cspdiag.optimize.variables import with_assignments

LARGEST_NUMBER_OF_INSTANCES = 64
"""With more processes, following them would take too long."""


def as_single_class(network: Network) -> ProcessClass:
    """The outermost process with all others inlined. Raises NotStaticError if that is impossible."""
    if len(network.instances) > LARGEST_NUMBER_OF_INSTANCES:
        raise NotStaticError(f"there are more than {LARGEST_NUMBER_OF_INSTANCES} processes")
    classes = {entry.name: entry for entry in network.classes}
    entry = classes[network.top]
    assert isinstance(entry, ProcessClass)
    if entry.body is None:
        raise NotStaticError(f"{entry.name} is written by hand")
    while entry.instances:
        entry = _with_instances_inlined(entry, entry.body, classes)
    unwritten = may_be_unwritten(replaced(network, classes=(entry,)))[entry.name]
    if unwritten:
        raise NotStaticError(f"{min(unwritten)} may be read before it is written")
    return _with_variables(entry)


def _with_instances_inlined(entry: ProcessClass, body: Action | None, classes: dict[str, Any]) -> ProcessClass:
    assert body is not None
    runs = Counter(instances_run(body))
    numbers = EndNumbers(entry)
    inlined: dict[str, InlinedProcess] = {}
    for instance in entry.instances:
        inner = classes[instance.class_name]
        if isinstance(inner, SubmodelClass) or inner.body is None:
            raise NotStaticError(f"{instance.name} is written by hand", instance.span)
        if runs[instance.name] != 1:
            raise NotStaticError(f"{instance.name} is not run at one place", instance.span)
        inlined[instance.name] = InlinedProcess(instance, inner, entry, numbers, classes)

    def change(action: Action) -> Action:
        if isinstance(action, RunInstance):
            return inlined[action.instance].scope(action)
        return with_inner_actions(action, change)

    instances = inlined.values()
    return with_assignments(
        replaced(
            entry,
            channels=(*entry.channels, *(channel for part in instances for channel in part.channels)),
            instances=tuple(instance for part in instances for instance in part.instances),
            constants=(*entry.constants, *(constant for part in instances for constant in part.constants)),
            states=(*entry.states, *(state for part in instances for state in part.states)),
            creation=tuple(creation_with_inlined(entry, inlined)),
            body=change(body),
        )
    )


def _with_variables(entry: ProcessClass) -> ProcessClass:
    """The class with the inputs of control laws as variables: they are read at different times."""
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
