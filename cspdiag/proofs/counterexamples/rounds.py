"""Rounds of loops that a counterexample repeats many times, shown once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from cspdiag.base.record import record, replaced
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Party, Step

LONGEST = 24
"""A round of more steps is not found."""
FEWEST = 8
"""Rounds of the trace itself are shown one by one where they are fewer; the first and the last one always are."""


@record
class Repeated:
    """Steps that are repeated a number of times."""

    times: int
    steps: tuple[Step, ...]


def with_rounds(found: Counterexample, added: Iterable[tuple[int, Step]]) -> Counterexample:
    """The counterexample with further steps, each before the one of its own with that number.

    Their parties are at the places that the counterexample knows of them.
    """
    inserted: dict[int, list[Step]] = {}
    for before, step in added:
        inserted.setdefault(before, []).append(step)
    known: dict[tuple[str, str, str], Party] = {}
    for step in reversed(found.steps):
        known |= {(step.kind, step.channel, party.name): party for party in step.parties}
    steps: list[Step] = []
    for number, step in enumerate(found.steps):
        steps += (_placed(one, known) for one in inserted.get(number, ()))
        steps.append(step)
        known |= {(step.kind, step.channel, party.name): party for party in step.parties}
    steps += (_placed(one, known) for one in inserted.get(len(found.steps), ()))
    return replaced(found, steps=tuple(steps))


def _placed(step: Step, known: Mapping[tuple[str, str, str], Party]) -> Step:
    """An added step with its parties where they were known to do the same last."""
    parties = []
    for party in step.parties:
        same = known.get((step.kind, step.channel, party.name))
        parties.append(party if same is None else replaced(party, words=same.words, span=same.span))
    return replaced(step, parties=tuple(parties), added=True)


def repeated(steps: Sequence[Step]) -> Iterator[Repeated]:
    """The steps in order; of those that were added, what follows on itself only once."""
    position = 0
    while position < len(steps):
        end = position
        while end < len(steps) and steps[end].added:
            end += 1
        found = _round(steps[position:end])
        yield found or Repeated(1, (steps[position],))
        position += 1 if found is None else found.times * len(found.steps)


def shortened(steps: Sequence[Step]) -> Iterator[Repeated]:
    """The steps in order, for people: of those of the trace itself, too, the rounds of a loop between the first and the
    last only once.

    Values may go up or down by the same from round to round: those of the steps then say which there are.
    """
    own: list[Step] = []
    for part in repeated(steps):
        if part.times == 1 and not part.steps[0].added:
            own += part.steps
            continue
        yield from _own_rounds(own)
        own = []
        yield part
    yield from _own_rounds(own)


def _own_rounds(steps: Sequence[Step]) -> Iterator[Repeated]:
    position = 0
    while position < len(steps):
        length, times = _alike(steps, position)
        inner = position + length, position + (times - 1) * length
        if times - 2 >= FEWEST:
            yield from (Repeated(1, (step,)) for step in steps[position : inner[0]])
            rounds = steps[slice(*inner)]
            yield Repeated(times - 2, tuple(_summed_up(rounds[at::length]) for at in range(length)))
            yield from (Repeated(1, (step,)) for step in steps[inner[1] : inner[1] + length])
            position = inner[1] + length
        else:
            yield Repeated(1, (steps[position],))
            position += 1


def _alike(steps: Sequence[Step], start: int) -> tuple[int, int]:
    """The shortest round that follows on itself often enough from a step on, but for values that count, and how often;
    (1, 1) without one.
    """
    for length in range(1, LONGEST + 1):
        end = start + length
        while end < len(steps) and _follows(steps, end, start, length):
            end += 1
        times = (end - start) // length
        if times - 2 >= FEWEST:
            return length, times
    return 1, 1


def _follows(steps: Sequence[Step], at: int, start: int, length: int) -> bool:
    """Whether a step is the one of the round before, and its value as much more as that was more than in the round
    before that.
    """
    one, other = steps[at], steps[at - length]
    if (one.kind, one.channel, one.parties) != (other.kind, other.channel, other.parties):
        return False
    more = _more(one, other)
    return more is not None and (at - 2 * length < start or more == _more(other, steps[at - 2 * length]))


def _more(one: Step, other: Step) -> int | None:
    """How much more the value of a step is; None where they are others that are no whole numbers."""
    if one.value == other.value:
        return 0
    try:
        return int(one.value or "") - int(other.value or "")
    except ValueError:
        return None


def _summed_up(steps: Sequence[Step]) -> Step:
    """What is the same step in each round, with all its values: ``7``, ``1 … 480`` or ``0, 5 … 495``."""
    first, second, last = steps[0], steps[1], steps[-1]
    match _more(second, first):
        case 0:
            return first
        case 1 | -1:
            return replaced(first, value=f"{first.value} … {last.value}")
        case _:  # Other differences, of all sizes.
            return replaced(first, value=f"{first.value}, {second.value} … {last.value}")


def _round(steps: Sequence[Step]) -> Repeated | None:
    """The shortest sequence that the steps begin with and that follows on itself."""
    for length in range(1, min(LONGEST, len(steps) // 2) + 1):
        times = 1
        while _same(steps[:length], steps[times * length : (times + 1) * length]):
            times += 1
        if times > 1:
            return Repeated(times, tuple(steps[:length]))
    return None


def _same(one: Sequence[Step], other: Sequence[Step]) -> bool:
    return len(one) == len(other) and all(
        (mine.kind, mine.channel, mine.value, mine.parties) == (yours.kind, yours.channel, yours.value, yours.parties)
        for mine, yours in zip(one, other, strict=True)
    )
