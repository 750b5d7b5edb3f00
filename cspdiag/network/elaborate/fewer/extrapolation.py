"""What a program with many elements is made of, from what it is with few and with some more.

Two things that were made of programs that differ in one size are compared: a number that differs grows in proportion to
the size, and where one has more rows than the other, rows in sequence differ in numbers that count (``runs``), and the
larger program has more of them. Whether that holds for all sizes is not asked here: it has to be known of the programs
(``regular``).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain
from typing import Any, TypeVar

from cspdiag.base import Span
from cspdiag.base.record import field_names, is_record, replaced
from cspdiag.network.elaborate.fewer.rows import Repetition, rows_of
from cspdiag.network.elaborate.fewer.runs import INDEX, Run, rows_like, runs

T = TypeVar("T")


class IrregularError(Exception):
    """Two things do not differ in such a way that a third one follows."""


class Extrapolation:
    """From the sizes ``few`` and ``some`` to the size ``many``.

    With ``only_ends`` a run has only its first and last rounds, so what is made is small.
    """

    def __init__(self, few: int, some: int, many: int, *, only_ends: bool = False) -> None:
        self.few = few
        self.some = some
        self.many = many
        self.only_ends = only_ends

    def of(self, one: T, other: T) -> T:
        """What has the size ``many``, from what has the sizes ``few`` and ``some``. Raises IrregularError."""
        found: T = self._item(one, other)
        return found

    def _item(self, one: Any, other: Any) -> Any:
        if one is other:
            return other
        kind = type(other)
        if type(one) is not kind:
            raise IrregularError
        if kind is int:
            return self._number(one, other)
        if kind is str:
            return self._text(one, other)
        if kind is tuple:
            return self._rows(one, other)
        if kind is Span or not is_record(other):
            if one != other:
                raise IrregularError
            return other
        pairs = {name: (getattr(one, name), getattr(other, name)) for name in field_names(other)}
        made = {name: self._item(*pair) for name, pair in pairs.items()}
        changes = {name: value for name, value in made.items() if value is not pairs[name][1]}
        return replaced(other, **changes) if changes else other

    def _number(self, one: int, other: int) -> int:
        """A number that becomes -1, 0 or 1 only with many elements may be treated as none with few is."""
        if one == other:
            return other
        step, rest = divmod(other - one, self.some - self.few)
        number = other + step * (self.many - self.some)
        if rest or number in _SPECIAL:
            raise IrregularError
        return number

    def _text(self, one: str, other: str) -> str:
        if one == other:
            return other
        if INDEX.sub("", one) != INDEX.sub("", other):
            raise IrregularError
        pairs = zip(INDEX.findall(one), INDEX.findall(other), strict=True)
        indexes = iter([self._number(int(before), int(after)) for before, after in pairs])
        return INDEX.sub(lambda _: str(next(indexes)), other)

    def _rows(self, one: tuple[Any, ...], other: tuple[Any, ...]) -> tuple[Any, ...]:
        if len(one) == len(other) and not self.only_ends:
            made = tuple([self._item(before, after) for before, after in zip(one, other, strict=True)])
            return other if all(new is old for new, old in zip(made, other, strict=True)) else made
        before, after = list(runs(one)), list(runs(other))
        if len(before) != len(after):
            raise IrregularError
        found: list[Iterable[Any]] = []
        repetitions: list[Repetition] = []
        start = 0
        for pair in zip(before, after, strict=True):
            rows, rounds = self._run(*pair)
            found.append(rows)
            length = len(pair[1].rows)
            repetitions.append(Repetition(start, length, rounds))
            start += length * rounds
        return rows_of(chain.from_iterable(found), repetitions)

    def _run(self, one: Run, other: Run) -> tuple[Iterable[Any], int]:
        """The rows of a run, and the number of its rounds."""
        if (one.rounds == 1) != (other.rounds == 1) or len(one.rows) != len(other.rows):
            raise IrregularError
        if other.rounds == 1:
            return map(self._item, one.rows, other.rows), 1
        if one.steps != other.steps:
            raise IrregularError
        rounds = self._number(one.rounds, other.rounds)
        columns = []
        for row, before, after, steps in zip(other.rows, one.outlines, other.outlines, one.steps, strict=True):
            if before.shape != after.shape:
                raise IrregularError
            numbers = list(zip(map(self._number, before.numbers, after.numbers), steps, strict=True))
            self._require_known(numbers, one.rounds, rounds)
            if self.only_ends:
                numbers = [(first, step * (rounds - 1)) for first, step in numbers]
            columns.append(rows_like(row, numbers, 2 if self.only_ends else rounds))
        rows = columns[0] if len(columns) == 1 else chain.from_iterable(zip(*columns, strict=True))
        return rows, 2 if self.only_ends else rounds

    def _require_known(self, numbers: Sequence[tuple[int, int]], known: int, rounds: int) -> None:
        """Numbers that count are -1, 0 or 1 at most in rounds that few elements have, too."""
        for first, step in numbers:
            for special in _SPECIAL if step else ():
                place, rest = divmod(special - first, step)
                if rest == 0 and known <= place < rounds:
                    raise IrregularError


_SPECIAL = (-1, 0, 1)
