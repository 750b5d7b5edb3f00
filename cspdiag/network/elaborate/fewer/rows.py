"""Rows of a network of which it is known where they repeat, so that nobody has to look at each."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple, TypeVar

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)


class Strand(NamedTuple):
    """Rows at equal distances that differ in numbers that count; a single row, if nothing is known of others."""

    start: int
    distance: int
    length: int

    def of(self, rows: Sequence[T]) -> Sequence[T]:
        """The rows themselves."""
        return rows[self.start : self.start + self.distance * (self.length - 1) + 1 : self.distance]


class Repetition(NamedTuple):
    """``rounds`` rounds of ``length`` rows each, from the row ``start`` on: a row differs from that of the round before
    in numbers only, indexes in names included, and each of them by the same step in all rounds.
    """

    start: int
    length: int
    rounds: int

    def of(self, rows: Sequence[T]) -> Sequence[T]:
        """The rows themselves."""
        return rows[self.start : self.start + self.length * self.rounds]

    def strands(self) -> Iterator[Strand]:
        """The rows in each place of a round."""
        return (Strand(first, self.length, self.rounds) for first in range(self.start, self.start + self.length))


class Rows(tuple[T_co, ...]):
    """Rows with the ``repetitions`` that they consist of, in their order; a row that does not repeat is one of one
    round.
    """

    repetitions: tuple[Repetition, ...]


def rows_of(rows: Iterable[T], repetitions: Iterable[Repetition]) -> tuple[T, ...]:
    """The rows, if any of them repeat with their repetitions."""
    found = tuple(repetitions)
    if all(repetition.rounds == 1 for repetition in found):
        return tuple(rows)
    made = Rows(rows)
    made.repetitions = found
    return made


def repetitions(rows: Sequence[object]) -> Sequence[Repetition]:
    """The repetitions that rows consist of: if nothing is known, all rows are one round."""
    return rows.repetitions if isinstance(rows, Rows) else (Repetition(0, len(rows), 1),)


def strands(rows: Sequence[object]) -> Iterator[Strand]:
    """The strands that rows consist of, in the order of the first row of each."""
    if isinstance(rows, Rows):
        for repetition in rows.repetitions:
            yield from repetition.strands()
    else:
        for position in range(len(rows)):
            yield Strand(position, 1, 1)


def examples(rows: Sequence[T]) -> Sequence[T]:
    """The rows without those that differ from one of these in numbers that count only."""
    return [rows[strand.start] for strand in strands(rows)] if isinstance(rows, Rows) else rows


def without_repeated(rows: Sequence[T], is_left_out: Callable[[T], bool]) -> Iterator[T]:
    """The rows, but of those that are known to repeat, and that are all to be left out, only the first round."""
    for repetition in repetitions(rows):
        first = rows[repetition.start : repetition.start + repetition.length]
        yield from first if repetition.rounds > 1 and all(map(is_left_out, first)) else repetition.of(rows)


def counted(rows: Sequence[T]) -> Iterator[tuple[T, T, int]]:
    """The first and the last of rows of which each differs from the one before in numbers that count, and their
    number.
    """
    for strand in strands(rows):
        yield rows[strand.start], rows[strand.start + strand.distance * (strand.length - 1)], strand.length


def rows_from(rows: Sequence[object], start: int) -> int:
    """The number of rows from ``start`` on of which each is known to differ from the one before in numbers that count
    by the same steps.
    """
    for repetition in rows.repetitions if isinstance(rows, Rows) else ():
        end = repetition.start + repetition.rounds
        if repetition.length == 1 and repetition.start <= start < end:
            return end - start
    return 1
