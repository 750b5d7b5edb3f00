"""Whether one small process refines another, by following both through everything that they can do."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal, TypeAlias

from tests.proofs.refine.small_processes import FIRST, Label, State, Statement, steps

MOST_UNSEEN = 300
"""The maximum number of states that hidden steps may reach."""
Truth: TypeAlias = Literal["refines", "violates", "not known"]


@dataclass(frozen=True)
class Sight:
    """How much of a process is visible.

    Inputs have ``numbers``. ``failures``: what is refused counts too. Communications at ``hidden`` are invisible.
    """

    numbers: tuple[int, ...]
    failures: bool
    hidden: str = ""

    def steps(self, state: State) -> Iterator[tuple[Label | None, State]]:
        """The possible steps in a state."""
        for label, after in steps(state, self.numbers):
            yield None if label is not None and label[0] == self.hidden else label, after


def refines(body: Statement, specification: Statement, sight: Sight, most: int) -> Truth:
    """Whether every sequence of communications of ``body``, with its end, is one of the specification; with failures,
    also whether it refuses only what may be refused.

    Not known if more than ``most`` pairs of states would have to be explored.
    """
    try:
        return _followed(body, specification, sight, most)
    except _TooManyError:
        return "not known"


class _TooManyError(Exception):
    """One of the processes can take too many hidden steps."""


def _followed(body: Statement, specification: Statement, sight: Sight, most: int) -> Truth:
    start: State = ((body,), FIRST)
    pending = [(start, _closed([((specification,), FIRST)], sight))]
    seen = set(pending)
    for state, allowed in pending:
        if not state[0] and all(after[0] for after in allowed):
            return "violates"
        if sight.failures and not _may_rest(state, allowed, sight):
            return "violates"
        for label, after in sight.steps(state):
            reached = allowed if label is None else _closed(_after(allowed, label, sight), sight)
            if not reached:
                return "violates"
            if (after, reached) not in seen:
                seen.add((after, reached))
                pending.append((after, reached))
        if len(pending) > most:
            return "not known"
    return "refines"


def _may_rest(state: State, allowed: Iterable[State], sight: Sight) -> bool:
    """Whether a process in this state continues by itself, or offers everything that some resting state of the
    specification offers.
    """
    offers = _offers(state, sight)
    return offers is None or any(
        demanded is not None and demanded <= offers for demanded in (_offers(other, sight) for other in allowed)
    )


def _offers(state: State, sight: Sight) -> set[object] | None:
    """What a process offers in a state; None if it continues by itself."""
    if not state[0]:
        return {"end"}
    labels = [label for label, _ in sight.steps(state)]
    return None if None in labels else {label for label in labels if label is not None}


def _after(states: Iterable[State], expected: Label, sight: Sight) -> list[State]:
    return [after for state in states for label, after in sight.steps(state) if label is not None and label == expected]


def _closed(states: Iterable[State], sight: Sight) -> frozenset[State]:
    """The states, and all that hidden steps reach from them."""
    seen = set(states)
    pending = list(seen)
    while pending:
        for label, after in sight.steps(pending.pop()):
            if label is None and after not in seen:
                if len(seen) > MOST_UNSEEN:
                    raise _TooManyError
                seen.add(after)
                pending.append(after)
    return frozenset(seen)
