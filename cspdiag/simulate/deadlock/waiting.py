"""The processes that wait when nothing can continue, as every kind of run reports them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cspdiag.base.record import record
from cspdiag.network.ir.actions import ChannelEnd, End, PortEnd
from cspdiag.network.ir.network import Network, ProcessClass, SubmodelClass
from cspdiag.network.relations import end_key
from cspdiag.network.shapes import element_name
from cspdiag.semantics.ends import ends_read


@record
class Offer:
    """A side of a channel at which a process waits: ``read`` or ``write``."""

    channel: str
    side: str

    @property
    def opposite(self) -> Offer:
        """The side at which a partner communicates."""
        return Offer(self.channel, "write" if self.side == "read" else "read")


@dataclass
class WaitingRecord:
    """A process, or a parallel part of one, that waits when nothing can continue.

    ``waits`` are words: ``to read Ring.link[2] or to write Ring.out``. ``missing`` are the processes at those ends of
    broadcasts that have not taken the value which this one writes; a process in which parallel parts read may be there
    several times.
    """

    path: str
    place: str
    waits: str
    channels: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()

    @property
    def offers(self) -> frozenset[Offer]:
        """Where it waits for a partner."""
        words = [offer.split(" ") for offer in self.waits.split(" or ")]
        return frozenset(Offer(word[2], word[1]) for word in words if word[0] == "to" and len(word) == 3)

    @property
    def line(self) -> int | None:
        """The line of the text at which it waits; None if unknown."""
        line = self.place.rpartition(":")[2]
        return int(line) if line.isdigit() else None


def broadcast_readers(network: Network) -> dict[str, list[str]]:
    """For each broadcast the process at each of its reading ends, in the order of their numbers: a process in which
    parallel parts read it has several.
    """
    classes = {entry.name: entry for entry in network.classes}
    instances = {item.path: classes[item.class_name] for item in network.instances}
    found: dict[str, list[str]] = {}
    for net in network.nets:
        if net.kind == "broadcast":
            known: dict[tuple[str, End], str] = {}
            for path, key in net.readers:
                entry = instances[path]
                if isinstance(entry, ProcessClass):
                    own = () if entry.body is None else ends_read(entry.body)
                    known |= {(path, end): path for end in own if end_key(end) == key} or {(path, PortEnd(key)): path}
                else:
                    # A law reads at an end of its process, which others that run before or after it may share.
                    around, _, name = path.rpartition(".")
                    known.setdefault((around, _input(instances[around], name, key)), path)
            found[net.path] = list(known.values())
    return found


def _input(around: ProcessClass[Any] | SubmodelClass, name: str, key: str) -> End:
    """The end of a process that an input of one of its laws is connected to."""
    assert isinstance(around, ProcessClass)
    (law,) = (instance for instance in around.instances if instance.name == name)
    (end,) = (
        connection.attachment
        for connection in law.connections
        if element_name(connection.port, connection.index) == key
    )
    assert isinstance(end, PortEnd | ChannelEnd)
    return end
