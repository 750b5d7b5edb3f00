"""Traces made shorter, and followed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cspdiag.proofs.verdict import Move


def causes(trace: Sequence[Move], components: Iterable[int]) -> tuple[Move, ...]:
    """The moves of a trace that the states of these components at its end depend on; the others can be left out."""
    concerned = set(components)
    kept = []
    for move in reversed(trace):
        parties = {party for party, _ in move.moves}
        if not parties.isdisjoint(concerned):
            concerned |= parties
            kept.append(move)
    return tuple(reversed(kept))


def end_of(initial: Sequence[int], trace: Iterable[Move]) -> tuple[int, ...]:
    """The states of the components after a trace."""
    state = list(initial)
    for move in trace:
        for party, after in move.moves:
            state[party] = after
    return tuple(state)
