"""The work of a thread from one wait to the next: upper and lower bounds over all paths."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from cspdiag.analyses.timing.flow.followed import FollowedEnds
from cspdiag.analyses.timing.threads.graph import Offer
from cspdiag.base.record import record

ChannelSide = tuple[str, bool]
"""A side of a channel: its path, and whether it is the writer's side."""
WaitState = tuple[int, FollowedEnds]
"""A wait, by the number of its place, and the ends that the thread follows there."""


@dataclass(slots=True)
class Path:
    """Bounds over all paths from a place to the next wait.

    ``work`` is the total execution time, ``first_step`` the part before the first switch to another thread and
    ``later_steps`` the longest step after it; ``switches`` counts these switches, ``delays`` the delays on the path and
    ``delay_time`` how long they last together. ``meets`` counts the communications that it waits for, by channel and
    side, ``sends`` those that it does not wait for. ``least_work`` and ``fewest_meets`` hold on every path;
    ``is_unique`` where there is only one. ``wait_states`` are the waits at which it may arrive, and ``still_followed``
    the periods of samples that are followed there. ``leaves`` are the laws that compute on a path, ``outputs`` the
    outputs that are written, ``certain_outputs`` those that are written on every path, ``moves`` the places that pass
    values on, ``certain_moves`` those that do so on every path.
    """

    work: int = 0
    least_work: int = 0
    first_step: int = 0
    later_steps: int = 0
    switches: int = 0
    delays: int = 0
    delay_time: int = 0
    meets: dict[ChannelSide, int] = field(default_factory=dict)
    fewest_meets: dict[ChannelSide, int] = field(default_factory=dict)
    sends: dict[ChannelSide, int] = field(default_factory=dict)
    wait_states: frozenset[WaitState] = frozenset()
    still_followed: frozenset[int] = frozenset()
    heaviest: tuple[int, str] = (0, "")
    leaves: frozenset[str] = frozenset()
    outputs: frozenset[str] = frozenset()
    certain_outputs: frozenset[str] = frozenset()
    moves: frozenset[int] = frozenset()
    certain_moves: frozenset[int] = frozenset()
    is_unique: bool = True

    @property
    def step(self) -> int:
        """The longest step."""
        return max(self.first_step, self.later_steps)

    @property
    def stops(self) -> frozenset[int]:
        """The waits at which it may arrive, by the numbers of their places."""
        return frozenset(number for number, _ in self.wait_states)

    def communications(self) -> Iterator[tuple[str, bool, int]]:
        """Each channel and side with the largest number of communications there, whether or not they are waited for."""
        for counts in (self.meets, self.sends):
            yield from ((channel, writes, count) for (channel, writes), count in counts.items())


@record
class Job:
    """What a thread does when a wait ends: where it waited, what ended the wait, and the path from there.

    With ``follows_samples`` the thread follows samples meanwhile, and has to wait for the next ones in time.
    """

    wait: int
    offer: Offer | None
    path: Path
    follows_samples: bool = False


def merge_branches(paths: Iterator[tuple[Path, int, bool, Offer | None, bool]]) -> Path:
    """The bounds over several branches.

    Each is given by the path after it, the delay before that, whether other threads may run in between, its
    communication, and whether that is waited for.
    """
    found = Path()
    least_work: list[int] = []
    fewest_meets: list[dict[ChannelSide, int]] = []
    certain_outputs: list[frozenset[str]] = []
    certain_moves: list[frozenset[int]] = []
    for after, delay, switches, offer, waits in paths:
        found.is_unique = after.is_unique and not least_work
        least_work.append(after.least_work)
        found.work = max(found.work, after.work)
        found.delay_time = max(found.delay_time, after.delay_time + delay)
        found.first_step = max(found.first_step, 0 if switches else after.first_step)
        found.later_steps = max(found.later_steps, after.step if switches else after.later_steps)
        found.switches = max(found.switches, after.switches + switches)
        found.delays = max(found.delays, after.delays + (delay > 0))
        found.wait_states |= after.wait_states
        found.still_followed |= after.still_followed
        found.leaves |= after.leaves
        found.outputs |= after.outputs
        certain_outputs.append(after.certain_outputs)
        certain_moves.append(after.certain_moves)
        found.moves |= after.moves
        found.heaviest = max(found.heaviest, after.heaviest, key=lambda part: part[0])
        met = offer.end if offer is not None else None
        _raise_counts(found.meets, after.meets, met if waits else None)
        _raise_counts(found.sends, after.sends, None if waits else met)
        fewest_meets.append(_with_one(after.fewest_meets, met if waits else None))
    found.least_work = min(least_work, default=0)
    found.certain_outputs = frozenset.intersection(*certain_outputs) if certain_outputs else frozenset()
    found.certain_moves = frozenset.intersection(*certain_moves) if certain_moves else frozenset()
    if fewest_meets:
        common = set.intersection(*(set(counts) for counts in fewest_meets))
        found.fewest_meets = {end: min(counts[end] for counts in fewest_meets) for end in common}
    return found


def _raise_counts(found: dict[ChannelSide, int], after: dict[ChannelSide, int], met: ChannelSide | None) -> None:
    for end, count in _with_one(after, met).items():
        found[end] = max(found.get(end, 0), count)


def _with_one(counts: dict[ChannelSide, int], met: ChannelSide | None) -> dict[ChannelSide, int]:
    return counts if met is None else counts | {met: counts.get(met, 0) + 1}
