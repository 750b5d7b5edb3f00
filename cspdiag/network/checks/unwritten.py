"""Variables that may be read before they have been written, which is then a fault.

The checks of a program assume that a part which may be abandoned has ended; here nothing is assumed about the body of a
``catch`` or ``interrupt``. In a program with neither of them, every variable is written before it is read.
"""

from __future__ import annotations

from cspdiag.network.flow.written import read_before_written
from cspdiag.network.ir.actions import CatchException, ChannelEnd, InterruptOn, PortEnd
from cspdiag.network.ir.network import Network, ProcessClass, channels_of
from cspdiag.network.ir.walk import all_actions


def may_be_unwritten(network: Network) -> dict[str, frozenset[str]]:
    """The variables of each class that may be read without a value; this includes every variable without an initial
    value to which an instance is attached.
    """
    classes = [entry for entry in network.classes if isinstance(entry, ProcessClass)]
    abandoned = any(
        isinstance(part, (CatchException, InterruptOn)) for entry in classes for part in all_actions(entry.body)
    )
    if not abandoned and not any(entry.external for entry in classes):
        return {entry.name: frozenset() for entry in classes}
    return {entry.name: _in_class(entry) for entry in classes}


def ports_of_unwritten(network: Network) -> dict[str, frozenset[tuple[str, int | None]]]:
    """The input ports of each class, with the index in an array, that may be connected to such a variable."""
    variables = may_be_unwritten(network)
    found: dict[str, set[tuple[str, int | None]]] = {entry.name: set() for entry in network.classes}
    inputs = {(entry.name, port.name) for entry in network.classes for port in entry.ports if port.direction == "in"}
    for entry in reversed(network.classes):
        if isinstance(entry, ProcessClass):
            for instance in entry.instances:
                for connection in instance.connections:
                    end = connection.attachment
                    if (instance.class_name, connection.port) not in inputs:
                        continue
                    if (isinstance(end, ChannelEnd) and end.channel in variables[entry.name]) or (
                        isinstance(end, PortEnd) and (end.port, end.index) in found[entry.name]
                    ):
                        found[instance.class_name].add((connection.port, connection.index))
    return {name: frozenset(places) for name, places in found.items()}


def _in_class(entry: ProcessClass) -> frozenset[str]:
    unset = {channel.name for channel in entry.channels if channel.kind == "var" and channel.initial is None}
    attached = channels_of(entry.instances)
    early = frozenset() if entry.body is None else read_before_written(entry.body, unset - attached)
    return early | (unset & attached)
