"""Iterations ("rounds") of loops that a counterexample repeats many times, shown once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby

from cspdiag.base.record import record, replaced
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Step

LONGEST = 24
"""Rounds with more steps than this are not recognized."""
FEWEST = 8
"""Fewer rounds than this are shown one by one; the first and the last round always are."""
FEWEST_OF_OTHER_VALUES = 24
"""The same for rounds in which values change irregularly."""


@record
class Repeated:
    """Steps that are repeated a number of times."""

    times: int
    steps: tuple[Step, ...]


def with_rounds(found: Counterexample, added: Iterable[tuple[int, Step]]) -> Counterexample:
    """The counterexample with further steps, each inserted before the step with that number."""
    inserted: dict[int, list[Step]] = {}
    for before, step in added:
        inserted.setdefault(before, []).append(replaced(step, added=True))
    steps: list[Step] = []
    for number, step in enumerate(found.steps):
        steps += (*inserted.get(number, ()), step)
    steps += inserted.get(len(found.steps), ())
    return replaced(found, steps=tuple(steps))


def repeated(steps: Sequence[Step]) -> Iterator[Repeated]:
    """The steps in order, for machines. Of the added steps, those that repeat are given once, with the number of times,
    and those in between as one group.
    """
    for added, group in groupby(steps, key=lambda step: step.added):
        if added:
            yield from _compressed(tuple(group))
        else:
            yield from (Repeated(1, (step,)) for step in group)


def _compressed(steps: tuple[Step, ...]) -> Iterator[Repeated]:
    single = position = 0
    while position < len(steps):
        found = _alike(steps, position, 0, _is_same)
        if found is None:
            position += 1
            continue
        if single < position:
            yield Repeated(1, steps[single:position])
        length, times = found
        yield Repeated(times, steps[position : position + length])
        single = position = position + times * length
    if single < position:
        yield Repeated(1, steps[single:])


def shortened(steps: Sequence[Step]) -> Iterator[Repeated]:
    """The steps in order, for people: of many rounds of a loop, all between the first and the last are shown as one.

    If a value increases or decreases by the same amount in each round, the step shows the progression of values; of
    other values, if there are many rounds, the first and the last.
    """
    position = 0
    while position < len(steps):
        found = _alike(steps, position, FEWEST, _counts) or _alike(steps, position, FEWEST_OF_OTHER_VALUES, _is_alike)
        if found is None:
            yield Repeated(1, (steps[position],))
            position += 1
            continue
        length, times = found
        inner = position + length, position + (times - 1) * length
        yield from (Repeated(1, (step,)) for step in steps[position : inner[0]])
        rounds = steps[slice(*inner)]
        yield Repeated(times - 2, tuple(_summed_up(rounds[at::length]) for at in range(length)))
        yield from (Repeated(1, (step,)) for step in steps[inner[1] : inner[1] + length])
        position = inner[1] + length


def _alike(
    steps: Sequence[Step], start: int, fewest: int, follows: Callable[[Sequence[Step], int, int, int], bool]
) -> tuple[int, int] | None:
    """The length of the shortest round that repeats from a step on, judged by ``follows``, and how often; None unless
    there are at least ``fewest`` rounds between the first and the last.
    """
    for length in range(1, LONGEST + 1):
        end = start + length
        while end < len(steps) and follows(steps, end, start, length):
            end += 1
        times = (end - start) // length
        if times - 2 >= fewest:
            return length, times
    return None


def _is_alike(steps: Sequence[Step], at: int, start: int, length: int) -> bool:
    """Whether a step is the same as in the previous round, whatever its value."""
    one, other = steps[at], steps[at - length]
    return (one.kind, one.channel, one.parties) == (other.kind, other.channel, other.parties)


def _is_same(steps: Sequence[Step], at: int, start: int, length: int) -> bool:
    """Whether a step is the same as in the previous round, with the same value."""
    return _is_alike(steps, at, start, length) and steps[at].value == steps[at - length].value


def _counts(steps: Sequence[Step], at: int, start: int, length: int) -> bool:
    """Whether a step is the same as in the previous round, and its value has changed by the same amount as in that
    round.
    """
    if not _is_alike(steps, at, start, length):
        return False
    more = _more(steps[at], steps[at - length])
    return more is not None and (at - 2 * length < start or more == _more(steps[at - length], steps[at - 2 * length]))


def _more(one: Step, other: Step) -> int | None:
    """The difference of the values of two steps; None if they differ and are not whole numbers."""
    if one.value == other.value:
        return 0
    try:
        return int(one.value or "") - int(other.value or "")
    except ValueError:
        return None


def _summed_up(steps: Sequence[Step]) -> Step:
    """One step for the same step of all rounds, with all its values: ``7``, ``1 … 480`` or ``0, 5 … 495``; of irregular
    values the first and the last, ``2 to 1024``.
    """
    first, second, last = steps[0], steps[1], steps[-1]
    more = {_more(one, other) for one, other in zip(steps[1:], steps, strict=False)}
    if more == {0}:
        return first
    if len(more) > 1 or None in more:
        return replaced(first, value=f"{_short(first.value)} to {_short(last.value)}")
    if more <= {1, -1}:
        return replaced(first, value=f"{first.value} … {last.value}")
    return replaced(first, value=f"{first.value}, {second.value} … {last.value}")


def _short(value: str | None) -> str:
    """A value with at most six digits."""
    try:
        return str(value) if value is None or "." not in value else f"{float(value):.6g}"
    except ValueError:
        return str(value)
