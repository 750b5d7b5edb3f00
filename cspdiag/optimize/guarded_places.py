"""Which ports and channels are guarded by an alternative or an interrupt, by class."""

from __future__ import annotations

from typing import TypeAlias, assert_never

from cspdiag.base.record import record
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.network import ConstantEnd, DiscardEnd, Network, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import parts

PortOrChannel: TypeAlias = "tuple[str, int | None] | str"
"""A port with its index in an array, or the name of a channel."""


@record
class Guards:
    """The ports and channels of a class that are guarded, by the class itself or by an instance inside."""

    reads: frozenset[PortOrChannel]
    writes: frozenset[PortOrChannel]


def port_or_channel(end: ir.End) -> PortOrChannel:
    """The port or channel of an end."""
    return (end.port, end.index) if isinstance(end, ir.PortEnd) else end.channel


def guards_by_class(network: Network) -> dict[str, Guards]:
    """The guarded ports and channels of every process class; for a process written by hand that is every port."""
    found: dict[str, Guards] = {}
    for entry in network.classes:
        if isinstance(entry, SubmodelClass):
            found[entry.name] = Guards(frozenset(), frozenset())
        elif entry.external is not None:
            found[entry.name] = _all_ports(entry)
        else:
            found[entry.name] = _guards(entry, found)
    return found


def _all_ports(entry: ProcessClass) -> Guards:
    places: dict[str, set[PortOrChannel]] = {"in": set(), "out": set()}
    for port in entry.ports:
        indexes = [None] if port.size is None else range(port.size)
        places[port.direction].update((port.name, index) for index in indexes)
    return Guards(frozenset(places["in"]), frozenset(places["out"]))


def _guards(entry: ProcessClass, known: dict[str, Guards]) -> Guards:
    reads: set[PortOrChannel] = set()
    writes: set[PortOrChannel] = set()
    for part in parts(entry.body):
        if isinstance(part, ir.Choice | ir.InterruptOn):
            for branch in part.branches if isinstance(part, ir.Choice) else (part.branch,):
                match branch.event:
                    case ir.InputEvent(source=source) | ir.ReadyEvent(source=source):
                        reads.add(port_or_channel(source))
                    case ir.OutputEvent(sink=sink):
                        writes.add(port_or_channel(sink))
                    case ir.AfterEvent() | ir.SkipEvent():
                        pass
                    case _:
                        assert_never(branch.event)
    for instance in entry.instances:
        inside = known[instance.class_name]
        if inside.reads or inside.writes:
            for connection in instance.connections:
                if not isinstance(connection.attachment, ConstantEnd | DiscardEnd):
                    port = (connection.port, connection.index)
                    if port in inside.reads:
                        reads.add(port_or_channel(connection.attachment))
                    if port in inside.writes:
                        writes.add(port_or_channel(connection.attachment))
    return Guards(frozenset(reads), frozenset(writes))
