"""Reading ends that matter although they are never read: the writer of a broadcast waits for each of them."""

from __future__ import annotations

from typing import Any

from cspdiag.network.ir.actions import ChannelEnd, PortEnd
from cspdiag.network.ir.network import ProcessClass
from cspdiag.network.ir.walk import parts


def possible_broadcasts(entry: ProcessClass) -> frozenset[str]:
    """The ports and channels that are, or may be, of kind ``broadcast``; where media are not known yet, any port may
    be.
    """
    ports = [p.name for p in entry.ports if not p.media or any(medium.kind == "broadcast" for medium in p.media)]
    return frozenset([*ports, *(channel.name for channel in entry.channels if channel.kind == "broadcast")])


def ends_at(item: Any, places: frozenset[str]) -> frozenset[Any]:
    """The ends of these ports and channels in an action."""
    if not places:
        return frozenset()
    ends = [part for part in parts(item) if isinstance(part, PortEnd | ChannelEnd)]
    return frozenset(end for end in ends if (end.port if isinstance(end, PortEnd) else end.channel) in places)
