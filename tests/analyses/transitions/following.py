"""Follows the communications of a run through a transition system: the system allows whatever the program does."""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Sequence
from itertools import product

from cspdiag.analyses.transitions.system import INTERNAL, System
from cspdiag.model.types import Type
from cspdiag.network.dump_expression import value_text

Communication = tuple[str, object]
"""The channel and the value that passed."""

OBSERVED = frozenset({"communication", "external", "sample"})
"""The kinds of events that are in the trace of a run."""

State = tuple[int, ...]


def moves(system: System, state: State) -> Iterator[tuple[int, State]]:
    """All steps out of a state: the event, or INTERNAL, and the state after it."""
    offers: dict[int, dict[int, list[int]]] = {}
    for number, (component, local) in enumerate(zip(system.components, state, strict=True)):
        for event, target in component.edges[local]:
            if event == INTERNAL:
                yield INTERNAL, (*state[:number], target, *state[number + 1 :])
            else:
                offers.setdefault(event, {}).setdefault(number, []).append(target)
    for event, of in offers.items():
        if len(of) == len(system.events[event].parties):
            for targets in product(*of.values()):
                after = list(state)
                for number, target in zip(of, targets, strict=True):
                    after[number] = target
                yield event, tuple(after)


class Lost(Exception):  # noqa: N818
    """The system does not allow what the program did."""


def follow(
    system: System, run: Sequence[Communication], types: dict[str, Type], unseen_channels: set[str], limit: int = 60_000
) -> State | None:
    """A state in which the system may be after the communications of a run; None if ``limit`` states were not enough to find one.

    ``unseen_channels`` are those whose communications are not in ``run``.

    Raises Lost, with what could not be followed, if there is none.
    """
    texts = [(channel, value_text(value, types[channel])) for channel, value in run]  # type: ignore[arg-type]
    start = (system.initial, 0)
    seen = {start}
    pending = [(0, 0, 0, start)]
    furthest, counter = 0, 0
    while pending:
        _, unseen, _, (state, done) = heapq.heappop(pending)
        if done == len(texts):
            return state
        if done > furthest:
            furthest = done
        for event, after in moves(system, state):
            step = done
            known = None if event == INTERNAL else system.events[event]
            if known is not None and known.kind in OBSERVED and known.channel not in unseen_channels:
                if known.channel != texts[done][0] or known.value not in (None, texts[done][1]):
                    continue
                step += 1
            following = (after, step)
            if following not in seen:
                seen.add(following)
                counter += 1
                if counter > limit:
                    return None
                heapq.heappush(pending, (-step, 0 if step > done else unseen + 1, counter, following))
    raise Lost(
        f"after {furthest} of {len(texts)} communications {texts[max(0, furthest - 6) : furthest]}: {texts[furthest]}"
    )
