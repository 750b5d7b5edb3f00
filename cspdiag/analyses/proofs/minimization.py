"""Compositional minimization: processes are put together two by two, what happens between them is hidden, and each result is made as small as possible.

The pair that promises the smallest result comes next (Graf and Steffen, "Compositional minimization of finite state systems", 1990; Crouzen and Lang, "Smart
reduction", 2011). Identical pairs are made once. Only whether there is a deadlock, or a knot, can be seen in the last machine: a trace to it is searched.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from heapq import heapify, heappop, heappush

from cspdiag.analyses.proofs import breadth_first, stubborn
from cspdiag.analyses.proofs.knots_as_deadlocks import knots_as_deadlocks
from cspdiag.analyses.proofs.parallel_machines import MOST_STATES, Pairs, Part, TooLargeError, part_of
from cspdiag.analyses.proofs.verdict import LimitError, Limits, Proved, Refuted, Unknown, Verdict
from cspdiag.analyses.transitions.system import System

_MOST_GIVEN_UP = 10
"""Pairs that were too large, after which no further pair is tried."""


def deadlock_free(system: System, limits: Limits) -> Verdict:
    """Whether no state is reachable in which nothing is possible and a process has not ended."""
    return _decide(system, system, limits, stubborn.deadlock_free, "at last none stands still")


def knot_free(system: System, limits: Limits) -> Verdict:
    """Whether no state is reachable in which some processes wait for each other for ever, whatever the others do."""
    return _decide(system, knots_as_deadlocks(system), limits, _some_knot, "none of them can be stuck")


def _some_knot(system: System, limits: Limits) -> Verdict:
    found = stubborn.knot_free(system, limits)
    return breadth_first.knot_free(system, limits) if isinstance(found, Unknown) else found


def _decide(
    system: System, reduced: System, limits: Limits, search: Callable[[System, Limits], Verdict], conclusion: str
) -> Verdict:
    """Whether the second system has no deadlock; if it has one, the search finds what it stands for in the first."""
    try:
        reduction = _Reduction(reduced, limits)
        remaining = list(reduction.remaining())
    except LimitError as stop:
        return Unknown("minimization", str(stop))
    if reduction.too_large:
        reason = f"no two of the last {len(remaining)} parts have at most {MOST_STATES} states together"
        return Unknown("minimization", reason)
    if not _stands_still(remaining):
        reason = (
            f"put together two by two and made minimal, the processes never had more than {reduction.largest} states"
        )
        return Proved("minimization", f"{reason}, and {conclusion}", reduction.largest)
    found = search(system, limits)
    if isinstance(found, Refuted):
        return found
    return Unknown("minimization", "some processes can be stuck, but the search for a trace to it reached a limit")


def _stands_still(parts: list[Part]) -> bool:
    """Whether all parts, which have nothing in common, can stand still at once, with a process that has not ended."""
    ways = [
        {ended for ended, edges in zip(part.machine.ended, part.machine.edges, strict=True) if not edges}
        for part in parts
    ]
    return all(ways) and any(False in ended for ended in ways)


class _Reduction:
    """Parts by number, and how many of an event's parties are still apart."""

    def __init__(self, system: System, limits: Limits) -> None:
        self._limits = limits
        self._pairs = Pairs(limits)
        self.largest = 1
        self.too_large = False
        """Whether parts that have events in common are left, because no two can be put together."""
        alphabets: list[set[int]] = [set() for _ in system.components]
        for event, known in enumerate(system.events):
            for party in known.parties:
                alphabets[party].add(event)
        alone = {event for event, known in enumerate(system.events) if len(known.parties) == 1}
        self._parts = {
            at: self._pairs.minimal(part_of(component, alphabets[at], alone))
            for at, component in enumerate(system.components)
        }
        self._members: dict[int, set[int]] = {
            event: set(known.parties) for event, known in enumerate(system.events) if event not in alone
        }
        self._queue = [self._ranked(one, other) for one, other in sorted(self._neighbours())]
        heapify(self._queue)

    def remaining(self) -> Iterator[Part]:
        """The parts that are left when no two have an event in common, or are worth putting together. Raises LimitError."""
        number = len(self._parts)
        given_up: set[tuple[int, int]] = set()
        while self._queue and len(given_up) < _MOST_GIVEN_UP:
            _, one, other = heappop(self._queue)
            if one not in self._parts or other not in self._parts:
                continue
            self._limits.check()
            try:
                self._put_together(one, other, number)
            except TooLargeError:
                given_up.add((one, other))
            number += 1
        self.too_large = any(len(members) > 1 for members in self._members.values())
        yield from self._parts.values()

    def _put_together(self, one: int, other: int, number: int) -> None:
        first, second = self._parts[one], self._parts[other]
        events = {*first.events, *second.events}
        inside = {event for event in events if self._members[event] <= {one, other}}
        part = self._pairs.together(first, second, inside)
        del self._parts[one], self._parts[other]
        for event in inside:
            self._members[event].clear()
        for event in events - inside:
            self._members[event] -= {one, other}
            self._members[event].add(number)
        self._parts[number] = part
        self.largest = max(self.largest, len(part.machine.edges))
        for neighbour in {member for event in part.events for member in self._members[event]} - {number}:
            heappush(self._queue, self._ranked(neighbour, number))

    def _neighbours(self) -> set[tuple[int, int]]:
        return {
            (one, other) for members in self._members.values() for one in members for other in members if one < other
        }

    def _ranked(self, one: int, other: int) -> tuple[tuple[float, int], int, int]:
        """How much a pair promises: few states, and many events that only they have in common."""
        first, second = self._parts[one], self._parts[other]
        shared = set(first.events) & set(second.events)
        hidden = sum(self._members[event] <= {one, other} for event in shared)
        events = len(first.events) + len(second.events) - len(shared)
        states = len(first.machine.edges) * len(second.machine.edges)
        return (states * (1 - hidden / (events + 1)), events), one, other
