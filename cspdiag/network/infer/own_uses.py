"""The ports and channels that the composition of a process itself reads and writes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from cspdiag.network.flow.effects import reads, writes
from cspdiag.network.ir.actions import ChannelEnd, PortEnd
from cspdiag.network.relations import end_key
from cspdiag.network.shapes import Key, Shape


def own_uses(shape: Shape) -> tuple[list[Key], list[Key]]:
    """The ports and channels that a process itself writes, and those that it reads, each once, in text order; uses in
    expressions do not count as reads.
    """
    if shape.body is None:
        return [], []
    written = _ends(place for instruction in shape.flow.instructions for place in writes(instruction))
    return list(dict.fromkeys(written)), list(dict.fromkeys(own_reads(shape)))


def own_reads(shape: Shape) -> Iterator[Key]:
    """The port or channel of each place where a process reads one itself."""
    return _ends(place for instruction in shape.flow.instructions for place in reads(instruction))


def _ends(places: Iterable[object]) -> Iterator[Key]:
    return (end_key(place) for place in places if isinstance(place, PortEnd | ChannelEnd))
