"""Variables that may be read before they have been written, which is then a fault.

The checks of a program assume that a part which may be abandoned has ended; here nothing is assumed about the body of a
``catch`` or ``interrupt``. In a program with neither of them, every variable is written before it is read.
"""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.network.elaborate.fewer.continued import continued
from cspdiag.network.flow.written import Run, read_before_written
from cspdiag.network.ir.actions import CatchException, ChannelEnd, InterruptOn, PortEnd
from cspdiag.network.ir.network import InstanceOf, Network, ProcessClass, SubmodelClass, channels_of
from cspdiag.network.ir.walk import all_actions


def may_be_unwritten(network: Network) -> dict[str, frozenset[str]]:
    """The variables of each class that may be read without a value; this includes every variable without an initial
    value to which an instance of a process, or of a law in another language, is attached.
    """
    return {name: frozenset(variables) for name, variables in _variables(network)}


@continued
def _variables(network: Network) -> tuple[tuple[str, tuple[str, ...]], ...]:
    classes = [entry for entry in network.classes if isinstance(entry, ProcessClass)]
    abandoned = any(
        isinstance(part, (CatchException, InterruptOn)) for entry in classes for part in all_actions(entry.body)
    )
    if not abandoned and not any(entry.external for entry in classes):
        return tuple((entry.name, ()) for entry in classes)
    laws = {entry.name: entry for entry in network.classes if isinstance(entry, SubmodelClass) and not entry.external}
    return tuple((entry.name, _in_class(entry, laws)) for entry in classes)


def ports_of_unwritten(network: Network) -> dict[str, frozenset[tuple[str, int | None]]]:
    """The input ports of each class, with the index in an array, that may be connected to such a variable."""
    return {name: frozenset(places) for name, places in _ports(network)}


@continued
def _ports(network: Network) -> tuple[tuple[str, tuple[tuple[str, int | None], ...]], ...]:
    variables = may_be_unwritten(network)
    found: dict[str, dict[tuple[str, int | None], None]] = {entry.name: {} for entry in network.classes}
    if not any(variables.values()):
        return tuple((name, ()) for name in found)
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
                        found[instance.class_name][connection.port, connection.index] = None
    return tuple((name, tuple(places)) for name, places in found.items())


def _in_class(entry: ProcessClass, laws: Mapping[str, SubmodelClass]) -> tuple[str, ...]:
    unset = {channel.name for channel in entry.channels if channel.kind == "var" and channel.initial is None}
    if not unset:
        return ()
    attached = channels_of(instance for instance in entry.instances if instance.class_name not in laws)
    runs = {each.name: _run(each, laws[each.class_name]) for each in entry.instances if each.class_name in laws}
    early = frozenset() if entry.body is None else read_before_written(entry.body, unset - attached, runs=runs)
    found = early | (unset & attached)
    return tuple(channel.name for channel in entry.channels if channel.name in found)


def _run(instance: InstanceOf, law: SubmodelClass) -> Run:
    inputs = {port.name for port in law.ports if port.direction == "in"}
    ends = [(each.port in inputs, each.attachment) for each in instance.connections]
    variables = [(is_read, end.channel) for is_read, end in ends if isinstance(end, ChannelEnd)]
    return Run(
        reads=frozenset(name for is_read, name in variables if is_read),
        writes=frozenset(name for is_read, name in variables if not is_read),
    )
