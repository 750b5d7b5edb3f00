"""Interrupts whose bodies may make their own guards ready: they have the other end of the channel."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import Call
from cspdiag.network.flow.effects import reads, writes
from cspdiag.network.ir.actions import ChannelEnd, End, InputEvent, InterruptOn, OutputEvent, PortEnd, ReadyEvent
from cspdiag.network.ir.network import CoreNetwork, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.network.relations import end_key


def guard_met_by_its_body(network: CoreNetwork) -> InterruptOn | None:
    """The first interrupt whose body may communicate with its guard.

    The body is then cancelled in the middle of that communication, and the process waits for its guard alone
    (docs/semantics.md, Interrupts 2 and 4).
    """
    ports_meet = _connects_to_itself(network)
    for entry in network.classes:
        if isinstance(entry, ProcessClass) and entry.body is not None:
            for part in parts(entry.body):
                if isinstance(part, InterruptOn) and _meets(part, entry, network, ports_meet):
                    return part
    return None


def _meets(interrupt: InterruptOn, entry: ProcessClass, network: CoreNetwork, ports_meet: bool) -> bool:
    event = interrupt.branch.event
    match event:
        case OutputEvent(sink=guard):
            others = _ends(interrupt, entry, network, reading=True)
        case InputEvent(source=guard) | ReadyEvent(source=guard):
            others = _ends(interrupt, entry, network, reading=False)
        case _:  # A time-out, or a guard that is always ready.
            return False
    if isinstance(guard, PortEnd):
        return ports_meet and any(isinstance(end, PortEnd) for end in others)
    return any(isinstance(end, ChannelEnd) and end_key(end) == end_key(guard) for end in others)


def _ends(interrupt: InterruptOn, entry: ProcessClass, network: CoreNetwork, *, reading: bool) -> Iterable[End]:
    """The ends that the body of an interrupt, or an instance that it runs, reads or writes."""
    instances = {instance.name: instance for instance in entry.instances}
    for instruction in flow_of(interrupt.body).instructions:
        if isinstance(instruction, Call):
            instance = instances[instruction.step.instance]
            ports = {port.name: port for port in network.class_named(instance.class_name).ports}
            for connection in instance.connections:
                end = connection.attachment
                if isinstance(end, PortEnd | ChannelEnd) and (ports[connection.port].direction == "in") is reading:
                    yield end
        else:
            places = reads(instruction) if reading else writes(instruction)
            yield from (place for place in places if isinstance(place, PortEnd | ChannelEnd))


def _connects_to_itself(network: CoreNetwork) -> bool:
    """Whether a channel connects an instance to itself: two of its ports are the ends of one channel."""
    for net in network.nets:
        owner = net.path.rpartition(".")[0] + "."
        writers, readers = (
            {path.removeprefix(owner).split(".")[0] for path, _ in ends if path.startswith(owner)}
            for ends in (net.writers, net.readers)
        )
        if not writers.isdisjoint(readers):
            return True
    return False
