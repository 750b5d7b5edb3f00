"""How often threads begin again."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.analyses.timing.flow.behaviours import Behaviour
from cspdiag.analyses.timing.flow.jobs import cycles
from cspdiag.analyses.timing.task import ONCE
from cspdiag.analyses.timing.threads.graph import Thread


def again(threads: Sequence[Thread], behaviours: Sequence[Behaviour], grid: int | None) -> dict[int, int]:
    """The threads that may begin more than once, each with the shortest time between, 0 where nothing tells.

    Those that are started come after those that start them.
    """
    numbers = {id(thread): k for k, thread in enumerate(threads)}
    known = {one.number: one for one in behaviours}
    found: dict[int, int] = {}
    for number, thread in enumerate(threads):
        one = known.get(number)
        for join, group in zip(thread.joins, thread.forks, strict=True):
            if one is None or number in found or join in one.loop_of:
                shortest = 0 if one is None else found.get(number, ONCE)
                if one is not None and join in one.loop_of:
                    shortest = min(shortest, round_period(one, join, grid))
                found |= dict.fromkeys((numbers[id(branch)] for branch in group), shortest)
    return found


def round_period(one: Behaviour, wait: int, grid: int | None) -> int:
    """The shortest time from one pass of a wait to the next but one, and so on; 0 where nothing tells.

    A wait without which there is no way back tells, if all that ends it takes time.
    """
    after = one.stops_after()
    loop = {other for other, cycle in one.loop_of.items() if cycle == one.loop_of.get(wait)}
    known = [0]
    for passed in loop:
        rest = {other: after.get(other, frozenset()) - {passed} for other in loop - {passed}}
        if not any(wait in cycle for cycle in cycles(rest)):
            known.append(min(_least_time(offer.kind, offer.period, grid) for offer in one.thread.places[passed].offers))
    return max(known)


def _least_time(kind: str, period: int, grid: int | None) -> int:
    if kind in ("sample", "delay"):
        return period
    return (grid or 0) if kind == "event" else 0
