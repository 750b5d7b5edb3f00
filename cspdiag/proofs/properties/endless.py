"""The answers to whether a run continues forever with certain events only."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from cspdiag.base.record import record
from cspdiag.proofs.verdict import Method, Move


@record
class Endless:
    """A run that never ends: ``trace`` from the initial state, then ``cycle`` forever."""

    method: Method
    trace: tuple[Move, ...]
    cycle: tuple[Move, ...]
    states: int | None = None


@record
class Finite:
    """No run has infinitely many of the events in a row; ``states`` is the number of states explored, None if none had
    to be.
    """

    method: Method
    states: int | None = None


def shortest_cycle(start: int, onward: Callable[[int], Iterable[tuple[Move, int]]]) -> tuple[Move, ...]:
    """The moves of a shortest way from a state back to itself, which there must be; ``onward`` gives the moves from a
    state with the states after them.
    """
    came: dict[int, tuple[int, Move]] = {}
    pending = [start]
    for member in pending:  # It grows.
        for move, after in onward(member):
            if after not in came:
                came[after] = (member, move)
                pending.append(after)
        if start in came:
            break
    cycle: list[Move] = []
    at = start
    while not cycle or at != start:
        at, move = came[at]
        cycle.append(move)
    return tuple(reversed(cycle))
