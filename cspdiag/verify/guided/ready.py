"""Which of the processes that are ready is next in a guided run."""

from __future__ import annotations

from collections.abc import Callable
from heapq import heapify, heappop, heappush, nsmallest

from cspdiag.runtime.kernel.party import Party
from cspdiag.runtime.kernel.scheduler import Priority
from cspdiag.verify.decisions import Decisions

MOST_CHOICES = 6
"""The number of ready processes that are tried as the next one."""


class ReadyParties:
    """The parties that are ready; of each level, those of the lowest ``rank`` are first."""

    def __init__(self, rank: Callable[[Party], int]) -> None:
        self._rank = rank
        self._levels: dict[Priority, list[tuple[int, int, Party]]] = {}
        self._added = 0

    def __bool__(self) -> bool:
        return any(self._levels.values())

    def add(self, level: Priority, party: Party) -> None:
        """One more."""
        self._added += 1
        heappush(self._levels.setdefault(level, []), (self._rank(party), self._added, party))

    def take(self, decisions: Decisions) -> Party | None:
        """Of the highest level that has any, the first one, or another as decided."""
        level = min((level for level, entries in self._levels.items() if entries), default=None)
        if level is None:
            return None
        entries = self._levels[level]
        chosen = decisions.choose(min(len(entries), MOST_CHOICES)) if len(entries) > 1 else 0
        if chosen == 0:
            return heappop(entries)[2]
        entry = nsmallest(chosen + 1, entries)[-1]
        entries.remove(entry)
        heapify(entries)
        return entry[2]
