"""Merges events that no proof needs to distinguish.

A channel that is written in two places of a process may have an event for each. If all parties except one take two
events from the same states to the same states, the system behaves the same if they become one event: which of them can
happen depends on that one party only, which moves as before.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeAlias

from cspdiag.proofs.transitions.systems.system import INTERNAL, System

Use: TypeAlias = frozenset[tuple[int, int]]
"""The states before and after an event in one component."""

NO_USE: Use = frozenset()


def representatives(system: System) -> list[int]:
    """For each event the first one that it need not be distinguished from, which may be the event itself."""
    answer = list(range(len(system.events)))
    groups: dict[tuple[tuple[int, ...], bool], list[int]] = {}
    for number, event in enumerate(system.events):
        groups.setdefault((event.parties, event.kind == "failure"), []).append(number)
    # Nearly all groups have a single event, and nothing to compare.
    shared = [group for (parties, _), group in groups.items() if len(group) > 1 and len(parties) > 1]
    uses = _uses(system, {number for group in shared for number in group})
    for group in shared:
        parties = system.events[group[0]].parties
        known: dict[tuple[int, Use], int] = {}
        before = [_chain(known, [uses.get((party, number), NO_USE) for party in parties]) for number in group]
        behind = [_chain(known, [uses.get((party, number), NO_USE) for party in parties[::-1]]) for number in group]
        for apart in range(len(parties)):
            first: dict[tuple[int, int], int] = {}
            for number, left, right in zip(group, before, behind, strict=True):
                answer[number] = first.setdefault((left[apart], right[len(parties) - 1 - apart]), number)
            if len(first) < len(group):
                break  # Those that were merged are used differently by one party already.
    return answer


def _chain(known: dict[tuple[int, Use], int], uses: Sequence[Use]) -> list[int]:
    """A number for what comes before each use: equal numbers for equal uses in equal order."""
    found = [0]
    for use in uses[:-1]:
        found.append(known.setdefault((found[-1], use), len(known) + 1))
    return found


def _uses(system: System, events: set[int]) -> dict[tuple[int, int], Use]:
    found: dict[tuple[int, int], set[tuple[int, int]]] = {}
    if events:
        for component in _parties(system, events):
            for state, edges in enumerate(system.components[component].edges):
                for event, after in edges:
                    if event != INTERNAL and event in events:
                        found.setdefault((component, event), set()).add((state, after))
    return {key: frozenset(use) for key, use in found.items()}


def _parties(system: System, events: Iterable[int]) -> set[int]:
    return {party for event in events for party in system.events[event].parties}
