"""The order in which the parts of a process are created: it decides which is served first if several wait for one
event.
"""

from __future__ import annotations

from cspdiag.network.ir.actions import ChannelEnd, Choice, End, InputEvent, PortEnd, ReadValue, ReadyEvent
from cspdiag.network.ir.network import CreatedChoice, CreatedInstance, MediumKind, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import all_actions, parts

MEDIA_WITH_READER_STATE: frozenset[MediumKind] = frozenset({"sampled", "event", "broadcast"})
"""The media that keep state for each reading end."""


def creation_order(
    entry: ProcessClass, submodels: dict[str, SubmodelClass]
) -> tuple[End | CreatedInstance | CreatedChoice, ...]:
    """Reading ends of ports, then of channels, then instances in text order, then alternatives in text order.

    Only ends whose medium keeps state for them count, in the order in which they first occur: in the composition, then
    at the inputs of the instances of ``submodels``. The elements of an array of ports stay together.
    """
    ends = _reading_ends(entry, submodels)
    choices = [part.name for part in all_actions(entry.body) if isinstance(part, Choice)]
    return (
        *_by_port([end for end in ends if isinstance(end, PortEnd)]),
        *(end for end in ends if isinstance(end, ChannelEnd)),
        *(CreatedInstance(instance.name) for instance in entry.instances),
        *map(CreatedChoice, choices),
    )


def _reading_ends(entry: ProcessClass, submodels: dict[str, SubmodelClass]) -> list[End]:
    broadcast = {channel.name for channel in entry.channels if channel.kind == "broadcast"}
    media = {port.name: port.media for port in entry.ports if port.direction == "in"}
    found: dict[End, None] = {}

    def add(end: object) -> None:
        match end:
            case ChannelEnd(channel=channel) if channel in broadcast:
                found[end] = None
            case PortEnd(port=port, index=index) if port in media:
                if media[port][index or 0].kind in MEDIA_WITH_READER_STATE:
                    found[end] = None

    for part in parts(entry.body):
        if isinstance(part, ReadValue | ReadyEvent | InputEvent):
            add(part.source)
    for instance in entry.instances:
        law = submodels.get(instance.class_name)
        if law is not None:
            read = {port.name for port in law.ports if port.direction == "in"}
            for connection in instance.connections:
                if connection.port in read:
                    add(connection.attachment)
    return list(found)


def _by_port(ends: list[PortEnd]) -> list[PortEnd]:
    groups: dict[tuple[str, int], list[PortEnd]] = {}
    for end in ends:
        groups.setdefault((end.port, end.end), []).append(end)
    return [end for group in groups.values() for end in sorted(group, key=lambda end: end.index or 0)]
