"""How often threads are started again."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.analyses.timing.flow.behaviours import Behaviour
from cspdiag.analyses.timing.flow.jobs import cycles
from cspdiag.analyses.timing.task import ONCE
from cspdiag.analyses.timing.threads.graph import Thread


def restart_intervals(threads: Sequence[Thread], behaviours: Sequence[Behaviour], grid: int | None) -> dict[int, int]:
    """The threads that may be started more than once, by number, each with the shortest time between two starts; 0
    where no shortest time is known.

    A thread comes after the one that starts it in ``threads``.
    """
    numbers = {id(thread): k for k, thread in enumerate(threads)}
    by_number = {one.number: one for one in behaviours}
    found: dict[int, int] = {}
    for number, thread in enumerate(threads):
        one = by_number.get(number)
        for join, group in zip(thread.joins, thread.forks, strict=True):
            if one is None or number in found or join in one.loop_of:
                shortest = 0 if one is None else found.get(number, ONCE)
                if one is not None and join in one.loop_of:
                    shortest = min(shortest, shortest_iteration(one, join, grid))
                found |= dict.fromkeys((numbers[id(branch)] for branch in group), shortest)
    return found


def shortest_iteration(one: Behaviour, wait: int, grid: int | None) -> int:
    """The shortest time from one pass of a wait to the next; 0 where no shortest time is known.

    It is known where every way back to the wait leads through another wait whose offers all take time.
    """
    after = one.next_waits()
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
