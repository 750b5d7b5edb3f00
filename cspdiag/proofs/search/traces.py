"""The relevant moves of traces, and the states that they lead to."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cspdiag.proofs.verdict import Move


def causes(trace: Sequence[Move], components: Iterable[int]) -> tuple[Move, ...]:
    """The moves of a trace on which the states of these components at its end depend; the others can be left out."""
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


def moves_to(number: int, parents: Sequence[tuple[int, Move] | None]) -> tuple[Move, ...]:
    """The moves from the initial state to a state; ``parents`` has for each state the one before it and the move
    between them, and None for the initial one.
    """
    moves = []
    while (parent := parents[number]) is not None:
        number, move = parent
        moves.append(move)
    return tuple(reversed(moves))
