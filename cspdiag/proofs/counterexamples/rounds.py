"""Rounds of loops that a counterexample repeats many times, shown once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby

from cspdiag.base.record import record, replaced
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Step

LONGEST = 24
"""A round of more steps is not found."""
FEWEST = 8
"""Rounds are shown one by one where they are fewer; the first and the last one always are."""
FEWEST_OF_OTHER_VALUES = 24
"""The same, where values change from round to round, and not always by the same."""


@record
class Repeated:
    """Steps that are repeated a number of times."""

    times: int
    steps: tuple[Step, ...]


def with_rounds(found: Counterexample, added: Iterable[tuple[int, Step]]) -> Counterexample:
    """The counterexample with further steps, each before the one of its own with that number."""
    inserted: dict[int, list[Step]] = {}
    for before, step in added:
        inserted.setdefault(before, []).append(replaced(step, added=True))
    steps: list[Step] = []
    for number, step in enumerate(found.steps):
        steps += (*inserted.get(number, ()), step)
    steps += inserted.get(len(found.steps), ())
    return replaced(found, steps=tuple(steps))


def repeated(steps: Sequence[Step]) -> Iterator[Repeated]:
    """The steps in order, for machines; of those that were added, what follows on itself only once, and together what
    does not.
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
    """The steps in order, for people: the rounds of a loop between the first and the last only once.

    Values may go up or down by the same from round to round: those of the steps then say which there are. Of other
    values, in many rounds, they say the first and the last.
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
    """The shortest round that follows on itself from a step on, as ``follows`` says, and how often: with ``fewest`` or
    more rounds between the first and the last.
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
    """Whether a step is the one of the round before, whatever its value."""
    one, other = steps[at], steps[at - length]
    return (one.kind, one.channel, one.parties) == (other.kind, other.channel, other.parties)


def _is_same(steps: Sequence[Step], at: int, start: int, length: int) -> bool:
    """Whether a step is the one of the round before, with its value."""
    return _is_alike(steps, at, start, length) and steps[at].value == steps[at - length].value


def _counts(steps: Sequence[Step], at: int, start: int, length: int) -> bool:
    """Whether a step is the one of the round before, and its value as much more as that was more than in the round
    before that.
    """
    if not _is_alike(steps, at, start, length):
        return False
    more = _more(steps[at], steps[at - length])
    return more is not None and (at - 2 * length < start or more == _more(steps[at - length], steps[at - 2 * length]))


def _more(one: Step, other: Step) -> int | None:
    """How much more the value of a step is; None where they are others that are no whole numbers."""
    if one.value == other.value:
        return 0
    try:
        return int(one.value or "") - int(other.value or "")
    except ValueError:
        return None


def _summed_up(steps: Sequence[Step]) -> Step:
    """What is the same step in each round, with all its values: ``7``, ``1 … 480`` or ``0, 5 … 495``; of others the
    first and the last, ``2 to 1024``.
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
    """A value of which the last digits do not matter."""
    try:
        return str(value) if value is None or "." not in value else f"{float(value):.6g}"
    except ValueError:
        return str(value)
