"""Rounds of loops that a counterexample goes round many times, told once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from cspdiag.base.record import record, replaced
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Party, Step

LONGEST = 24
"""A round of more steps is not found."""


@record
class Repeated:
    """Steps that follow each other so many times."""

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
