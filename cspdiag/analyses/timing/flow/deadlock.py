"""Whether two threads that communicate with each other can deadlock by waiting for each other on different channels."""

from __future__ import annotations

from cspdiag.analyses.timing.threads.graph import Offer, Place, Thread

LARGEST_NUMBER_OF_PAIRS = 40_000


def may_deadlock(one: Thread, other: Thread, between: frozenset[str]) -> bool:
    """Whether each thread may wait for the other alone, while neither offers what the other waits for.

    ``between`` are the channels that only these two threads use. Everything else that they wait for may come at any
    time, and a thread that has ended may begin again.
    """
    seen = {(one.entry, other.entry)}
    pending = list(seen)
    while pending:
        here, there = pending.pop()
        first, second = one.places[here], other.places[there]
        if _is_stuck(first, second, between):
            return True
        following = [(target, there) for target in _free(one, first, between)]
        following += [(here, target) for target in _free(other, second, between)]
        following += [
            (offer.target, met.target) for offer in first.offers for met in second.offers if _meet(offer, met)
        ]
        for pair in following:
            if pair not in seen:
                seen.add(pair)
                pending.append(pair)
        if len(seen) > LARGEST_NUMBER_OF_PAIRS:
            return True
    return False


def _free(thread: Thread, place: Place, between: frozenset[str]) -> list[int]:
    """The places where a thread may continue without the other one."""
    if not place.offers:
        return place.successors or [thread.entry]
    found = [offer.target for offer in place.offers if offer.kind != "partner" or offer.channel not in between]
    return found + place.successors


def _is_stuck(one: Place, other: Place, between: frozenset[str]) -> bool:
    return (
        _waits_only(one, between)
        and _waits_only(other, between)
        and not any(
            offer.is_certain and met.is_certain and _meet(offer, met) for offer in one.offers for met in other.offers
        )
    )


def _waits_only(place: Place, between: frozenset[str]) -> bool:
    """Whether everything that is certain to end a wait is a communication on one of some channels."""
    certain = [offer for offer in place.offers if offer.is_certain]
    return (
        bool(place.offers)
        and not place.polls
        and all(offer.kind == "partner" and offer.channel in between for offer in certain)
    )


def _meet(offer: Offer, met: Offer) -> bool:
    return offer.kind == met.kind == "partner" and offer.channel == met.channel and offer.writes != met.writes
