"""Reading ends that matter although nobody reads there: a writer waits for them."""

from __future__ import annotations

from typing import Any

from cspdiag.network.ir.actions import ChannelEnd, PortEnd
from cspdiag.network.ir.network import ProcessClass
from cspdiag.network.ir.walk import parts


def places_waited_for(entry: ProcessClass) -> frozenset[str]:
    """Ports and channels whose writer waits for every reading end, read or not; where media are not known, that may be
    any port.
    """
    ports = [p.name for p in entry.ports if not p.media or any(medium.kind == "broadcast" for medium in p.media)]
    return frozenset([*ports, *(channel.name for channel in entry.channels if channel.kind == "broadcast")])


def ends_of(item: Any, places: frozenset[str]) -> frozenset[Any]:
    """The ends of these ports and channels in an action."""
    if not places:
        return frozenset()
    ends = [part for part in parts(item) if isinstance(part, PortEnd | ChannelEnd)]
    return frozenset(end for end in ends if (end.port if isinstance(end, PortEnd) else end.channel) in places)
