"""Turns communication over ``var`` channels into assignments."""

from __future__ import annotations

from cspdiag.base.record import replaced
from cspdiag.network.ir.actions import Action, AssignValue, ChannelEnd, ReadValue, Target, WriteValue
from cspdiag.network.ir.expressions import VariableValue
from cspdiag.network.ir.network import Network, ProcessClass, SubmodelClass
from cspdiag.optimize.changes import changed, mapped, rebuilt


def variables(network: Network) -> Network:
    """The network without reads and writes of ``var`` channels by the process that owns them; guards and control laws
    keep theirs.
    """
    return changed(network, classes=mapped(network.classes, _in_class))


def _in_class(entry: ProcessClass | SubmodelClass) -> ProcessClass | SubmodelClass:
    return entry if isinstance(entry, SubmodelClass) else with_assignments(entry)


def with_assignments(entry: ProcessClass) -> ProcessClass:
    """The class with assignments for reads and writes of its variables."""
    types = {channel.name: channel.type for channel in entry.channels if channel.kind == "var"}

    def assigned(action: Action) -> Action:
        match action:
            case ReadValue(source=ChannelEnd(channel=name)) if name in types:
                value = VariableValue(type=types[name], channel=name, span=action.span)
                return AssignValue(span=action.span, target=action.target, value=value)
            case WriteValue(sink=ChannelEnd(channel=name)) if name in types:
                return AssignValue(span=action.span, target=Target(name), value=action.value)
            case _:  # Any other action is unchanged.
                return action

    if entry.body is None or not types:
        return entry
    body = rebuilt(entry.body, assigned)
    return entry if body is entry.body else replaced(entry, body=body)
