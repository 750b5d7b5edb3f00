"""Channels that processes read into variables."""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.network.actions import ChannelEnd, End, InputEvent, ReadValue
from cspdiag.network.ir import Network, ProcessClass
from cspdiag.network.walk import parts


def copied_nets(network: Network) -> dict[str, set[str]]:
    """By the path of a net, those of the variables that processes read it into."""
    net_of = {end: net.path for net in network.nets for end in (*net.writers, *net.readers)}
    classes = {entry.name: entry for entry in network.classes}
    reads = {
        name: [part for part in parts(entry.body) if isinstance(part, ReadValue | InputEvent)]
        for name, entry in classes.items()
        if isinstance(entry, ProcessClass) and entry.body is not None
    }
    found: dict[str, set[str]] = {}
    for instance in network.instances:
        for read in reads.get(instance.class_name, ()):
            source = net_path(instance.path, read.source, net_of)
            if source is not None:
                found.setdefault(source, set()).add(f"{instance.path}.{read.target.channel}")
    return found


def net_path(process: str, end: End, net_of: Mapping[tuple[str, str], str]) -> str | None:
    """The path of the net that an end of a process belongs to."""
    if isinstance(end, ChannelEnd):
        return f"{process}.{end.channel}"
    return net_of.get((process, end.port if end.index is None else f"{end.port}[{end.index}]"))
