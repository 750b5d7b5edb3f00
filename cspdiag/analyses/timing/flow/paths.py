"""What a thread does from one wait to the next, at most and at least."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from cspdiag.analyses.timing.flow.followed import Books
from cspdiag.analyses.timing.threads.graph import Offer
from cspdiag.base.record import record

ChannelSide = tuple[str, bool]
"""A side of a channel: its path, and whether it is that of the writer."""
Node = tuple[int, Books]
"""A wait, by its place, and the books with which a thread waits there."""


@dataclass(slots=True)
class Path:
    """The most that any way from here to the next wait takes.

    That is all work, the part before the first switch to another thread, the longest step after it, the number of
    switches, of delays and how long these are together, of communications for each channel and side (``meets`` where it
    waits for them, ``gives`` where it does not), the laws that compute on the way, the outputs that are written, and
    the places that hand values on. ``least`` is the work that every way takes, ``fewest`` the communications that it
    waits for on every way, ``is_only`` where there is but one. ``nodes`` are the waits that it may come to with the
    books there, and ``keeps`` the periods of samples that are still followed then.
    """

    work: int = 0
    least: int = 0
    first: int = 0
    later: int = 0
    switches: int = 0
    delays: int = 0
    delayed: int = 0
    meets: dict[ChannelSide, int] = field(default_factory=dict)
    fewest: dict[ChannelSide, int] = field(default_factory=dict)
    gives: dict[ChannelSide, int] = field(default_factory=dict)
    nodes: frozenset[Node] = frozenset()
    keeps: frozenset[int] = frozenset()
    heaviest: tuple[int, str] = (0, "")
    leaves: frozenset[str] = frozenset()
    outputs: frozenset[str] = frozenset()
    moves: frozenset[int] = frozenset()
    is_only: bool = True

    @property
    def step(self) -> int:
        """The longest step."""
        return max(self.first, self.later)

    @property
    def stops(self) -> frozenset[int]:
        """The waits that it may come to, by their places."""
        return frozenset(number for number, _ in self.nodes)

    def communications(self) -> Iterator[tuple[str, bool, int]]:
        """Of each channel and side how often it communicates at most, whether it waits for that or not."""
        for counts in (self.meets, self.gives):
            yield from ((channel, writes, count) for (channel, writes), count in counts.items())


@record
class Job:
    """What a thread does when a wait is over: where it waited, for what, and the path from there.

    ``is_owed`` tells that the thread follows samples meanwhile, which it has to be back for.
    """

    wait: int
    offer: Offer | None
    path: Path
    is_owed: bool = False


def either(paths: Iterator[tuple[Path, int, bool, Offer | None, bool]]) -> Path:
    """The path of several ways on.

    Of each what comes after it, the delay before, whether others may run meanwhile, and the communication, which is
    waited for or not.
    """
    found = Path()
    least: list[int] = []
    fewest: list[dict[ChannelSide, int]] = []
    for after, delay, switches, offer, waits in paths:
        found.is_only = after.is_only and not least
        least.append(after.least)
        found.work = max(found.work, after.work)
        found.delayed = max(found.delayed, after.delayed + delay)
        found.first = max(found.first, 0 if switches else after.first)
        found.later = max(found.later, after.step if switches else after.later)
        found.switches = max(found.switches, after.switches + switches)
        found.delays = max(found.delays, after.delays + (delay > 0))
        found.nodes |= after.nodes
        found.keeps |= after.keeps
        found.leaves |= after.leaves
        found.outputs |= after.outputs
        found.moves |= after.moves
        found.heaviest = max(found.heaviest, after.heaviest, key=lambda part: part[0])
        met = offer.end if offer is not None else None
        _most(found.meets, after.meets, met if waits else None)
        _most(found.gives, after.gives, None if waits else met)
        fewest.append(_with_one(after.fewest, met if waits else None))
    found.least = min(least, default=0)
    if fewest:
        common = set.intersection(*(set(counts) for counts in fewest))
        found.fewest = {end: min(counts[end] for counts in fewest) for end in common}
    return found


def _most(found: dict[ChannelSide, int], after: dict[ChannelSide, int], met: ChannelSide | None) -> None:
    for end, count in _with_one(after, met).items():
        found[end] = max(found.get(end, 0), count)


def _with_one(counts: dict[ChannelSide, int], met: ChannelSide | None) -> dict[ChannelSide, int]:
    return counts if met is None else counts | {met: counts.get(met, 0) + 1}
