"""The ends of sampled inputs that processes follow, and whether the sample of the last tick has been taken there.

A process follows an end from its first wait for a sample there until the process has ended.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum

from cspdiag.analyses.timing.threads.graph import InputEnd, Offer, Place


class SampleStatus(IntEnum):
    """What is known of the sample at an end that a process follows."""

    TAKEN = 0
    """The sample of the last tick has been taken, or the first one is waited for."""
    DUE = 1
    """The sample of the last tick has still to be taken."""
    POSSIBLE = 2
    """Parallel parts are analysed one after another in a thread: a part that comes later may already follow this end.
    """


FollowedEnds = frozenset[tuple[InputEnd, int, SampleStatus]]
NOTHING_FOLLOWED: FollowedEnds = frozenset()


def periods(followed: FollowedEnds) -> frozenset[int]:
    """The periods of the ends that are followed."""
    return frozenset(period for _, period, _ in followed)


def after_tick(followed: FollowedEnds, period: int) -> FollowedEnds:
    """After a tick of a period: at every end with this period a sample is due."""
    return frozenset((key, each, SampleStatus.DUE if each == period else status) for key, each, status in followed)


def with_status(followed: FollowedEnds, offers: Iterable[Offer], status: SampleStatus) -> FollowedEnds:
    """The same with another status of the ends of some offers."""
    changed = {offer.key: offer.period for offer in offers if offer.kind == "sample"}
    if not changed:
        return followed
    kept = frozenset(entry for entry in followed if entry[0] not in changed)
    return kept | {(key, period, status) for key, period in changed.items()}


def with_possible(followed: FollowedEnds, ends: Iterable[tuple[InputEnd, int]]) -> FollowedEnds:
    """The same with some more ends that may already be followed."""
    known = {key for key, _, _ in followed}
    return followed | {(key, period, SampleStatus.POSSIBLE) for key, period in ends if key not in known}


def is_due(followed: FollowedEnds, offer: Offer) -> bool:
    """Whether the sample that is offered is there for certain."""
    return (offer.key, offer.period, SampleStatus.DUE) in followed


def may_be_first_read(followed: FollowedEnds, offer: Offer, *, surely: bool = False) -> bool:
    """Whether this may be the first read of a process that already follows the period: it gets the sample of the last
    tick.
    """
    others = False
    for key, period, status in followed:
        if key == offer.key and status != SampleStatus.POSSIBLE:
            return False
        if key != offer.key and key[1] == offer.key[1] and period == offer.period:
            others |= status != SampleStatus.POSSIBLE or not surely
    return others


def is_surely_followed(followed: FollowedEnds, offer: Offer) -> bool:
    """Whether the end of an offer is followed for certain."""
    return any(key == offer.key and status != SampleStatus.POSSIBLE for key, _, status in followed)


def after_step(followed: FollowedEnds, place: Place, to: Place) -> FollowedEnds:
    """After a step from one place to another: ends are no longer followed when their process is left or begins anew."""
    if not followed or (place.path == to.path and not to.starts):
        return followed
    return frozenset(
        entry for entry in followed if not _is_within(place.path, entry[0][1]) or _is_kept(entry[0][1], to)
    )


def _is_kept(owner: str, to: Place) -> bool:
    return _is_within(to.path, owner) and not (to.starts and _is_within(owner, to.starts))


def _is_within(path: str, process: str) -> bool:
    return path == process or path.startswith(f"{process}.")
