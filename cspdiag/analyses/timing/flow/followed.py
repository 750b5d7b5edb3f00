"""The books that processes keep of their sampled inputs: which ends a process follows, and what of them it has taken.

An end is followed from the first wait for one of its samples until the process whose end it is has ended.
Each entry is an end with its period and how it stands.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum

from cspdiag.analyses.timing.threads.graph import Key, Offer, Place


class Standing(IntEnum):
    """How a process stands with an end that it follows."""

    TAKEN = 0
    """It has the sample of the last tick, or waits for a first one."""
    OWED = 1
    """The sample of the present tick is still to be taken."""
    AHEAD = 2
    """Parallel parts come one after another in a thread: one that comes later may follow this end already."""


Books = frozenset[tuple[Key, int, Standing]]
NOTHING: Books = frozenset()


def periods(books: Books) -> frozenset[int]:
    """The periods of which some end is followed."""
    return frozenset(period for _, period, _ in books)


def at_tick(books: Books, period: int) -> Books:
    """After a tick of a period: a sample of every end of it is to be taken."""
    return frozenset((key, each, Standing.OWED if each == period else stands) for key, each, stands in books)


def with_standing(books: Books, offers: Iterable[Offer], standing: Standing) -> Books:
    """The books with another standing of the ends of some offers."""
    changed = {offer.key: offer.period for offer in offers if offer.kind == "sample"}
    if not changed:
        return books
    kept = frozenset(entry for entry in books if entry[0] not in changed)
    return kept | {(key, period, standing) for key, period in changed.items()}


def opened(books: Books, ends: Iterable[tuple[Key, int]]) -> Books:
    """The books with some more ends that may be followed already."""
    known = {key for key, _, _ in books}
    return books | {(key, period, Standing.AHEAD) for key, period in ends if key not in known}


def is_owed(books: Books, offer: Offer) -> bool:
    """Whether the sample that is offered is there for certain."""
    return (offer.key, offer.period, Standing.OWED) in books


def is_first(books: Books, offer: Offer, *, surely: bool = False) -> bool:
    """Whether this may be a first read by a process that follows the period already: it has the sample of the present
    tick.
    """
    others = False
    for key, period, standing in books:
        if key == offer.key and standing != Standing.AHEAD:
            return False
        if key != offer.key and key[1] == offer.key[1] and period == offer.period:
            others |= standing != Standing.AHEAD or not surely
    return others


def is_open(books: Books, offer: Offer) -> bool:
    """Whether the end is followed for certain."""
    return any(key == offer.key and standing != Standing.AHEAD for key, _, standing in books)


def moved(books: Books, place: Place, to: Place) -> Books:
    """After a step from a place to another one: the books of a process are closed when it is left, or begins anew."""
    if not books or (place.path == to.path and not to.starts):
        return books
    return frozenset(entry for entry in books if not _is_within(place.path, entry[0][1]) or _is_kept(entry[0][1], to))


def _is_kept(owner: str, to: Place) -> bool:
    return _is_within(to.path, owner) and not (to.starts and _is_within(owner, to.starts))


def _is_within(path: str, process: str) -> bool:
    return path == process or path.startswith(f"{process}.")
