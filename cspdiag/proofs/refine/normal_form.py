"""A specification as a deterministic automaton: after each sequence of labels, which labels it allows next, and which
it must offer.

The nodes are the sets of states that one sequence can lead to (Roscoe, "Understanding Concurrent Systems", section
16.1.4). ``acceptances`` are the smallest sets of labels that its stable states offer.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from typing import TypeAlias

from cspdiag.base.record import record
from cspdiag.proofs.refine.labels import END, Label, covers
from cspdiag.proofs.search.closed_sets import ClosedSets
from cspdiag.proofs.transitions.systems.system import INTERNAL, System
from cspdiag.proofs.verdict import Limits

State: TypeAlias = tuple[int, ...]

_BYTES_PER_STATE = 400
"""The size of a tuple of some tens of small numbers, in a set."""


@record
class NormalNode:
    """What a specification allows after some traces. ``after`` has the next node for each label; a label that is
    missing is not allowed. ``offered`` are all labels that may follow.
    """

    after: dict[Label, int]
    acceptances: tuple[frozenset[Label], ...]
    offered: frozenset[Label] = frozenset()


def normal_form(
    specification: System, labels: dict[int, Label], asked: Collection[Label], limits: Limits
) -> tuple[NormalNode, ...]:
    """The automaton; its first node is the initial one. Raises LimitError.

    ``labels`` are those of the specification's events, ``asked`` those of the process.
    """
    walk = Walk(specification, labels)
    first = walk.closure([specification.initial], limits)
    numbers = {first: 0}
    pending = [first]
    nodes = []
    held = 0
    for states in pending:
        held += len(states)
        limits.check(held * _BYTES_PER_STATE)
        after = {}
        for label in asked:
            reached = walk.closure(walk.after(states, label), limits)
            if reached:
                if reached not in numbers:
                    numbers[reached] = len(pending)
                    pending.append(reached)
                after[label] = numbers[reached]
        resting = [walk.offers(state) for state in states if walk.is_stable(state)]
        if any(END in offered for offered in resting):
            after[END] = numbers[states]
        nodes.append(
            NormalNode(after, smallest(resting), frozenset(label for state in states for label in walk.offers(state)))
        )
    return tuple(nodes)


def smallest(sets: Iterable[frozenset[Label]]) -> tuple[frozenset[Label], ...]:
    """The sets that contain no other one of the sets."""
    every = sorted(set(sets), key=lambda found: (len(found), sorted(map(str, found))))
    kept: list[frozenset[Label]] = []
    for found in every:
        if not any(smaller <= found for smaller in kept):
            kept.append(found)
    return tuple(kept)


class Walk:
    """The steps of a specification, by label."""

    def __init__(self, system: System, labels: dict[int, Label]) -> None:
        self._system = system
        self._labels = labels
        self._steps = ClosedSets(system)

    def closure(self, states: Iterable[State], limits: Limits) -> frozenset[State]:
        """The states and all states reachable from them by unseen steps."""
        seen = set(states)
        pending = list(seen)
        while pending:
            limits.check(len(seen) * _BYTES_PER_STATE)
            for label, after in self._ways(pending.pop()):
                if label is None and after not in seen:
                    seen.add(after)
                    pending.append(after)
        return frozenset(seen)

    def after(self, states: Iterable[State], asked: Label) -> list[State]:
        """The states directly after a label."""
        return [
            after
            for state in states
            for label, after in self._ways(state)
            if label is not None and covers(label, asked)
        ]

    def is_stable(self, state: State) -> bool:
        """Whether no unseen step is possible."""
        return all(label is not None for label, _ in self._ways(state))

    def offers(self, state: State) -> frozenset[Label]:
        """The labels that a state offers; ``END`` if all processes have ended."""
        offered = frozenset(label for label, _ in self._ways(state) if label is not None)
        ended = not offered and all(
            local in component.terminal
            for local, component in zip(state, self._system.components, strict=True)
            if component.process
        )
        return frozenset({END}) if ended else offered

    def _ways(self, state: State) -> Iterator[tuple[Label | None, State]]:
        for event in self._steps.possible(state):
            for move, after in self._steps.moves(state, event):
                yield (None if move.event == INTERNAL else self._labels.get(move.event)), after
