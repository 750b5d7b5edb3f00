"""Which of several names are elements of arrays: ``cell[0]``, ``cell[1]``, ..., or ``cell0``, ``cell1``, ... where they
are many.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable, Collection, Hashable, Iterator, Mapping, Sequence
from itertools import accumulate, chain
from typing import Any, Generic, Protocol, TypeVar

from cspdiag.network.elaborate.fewer.rows import Strand, examples, strands

MANY = 100
"""From this number on, lines with numbered names are an array in generated code: nobody reads them one by one."""

NUMBER = r"(?<=[A-Za-z_])(?:0|[1-9][0-9]*)(?=\.|$)"
"""The number at the end of a name or of a part of a path."""

_NUMBER = re.compile(NUMBER)


class Named(Protocol):
    """A channel or an instance."""

    @property
    def name(self) -> str:
        """As in the text, with its index."""


N = TypeVar("N", bound=Named)
N_co = TypeVar("N_co", bound=Named, covariant=True)


class Elements(Generic[N_co]):
    """The elements of an array in order, of which some that follow one another are known to differ in numbers that
    count: ``strands`` of the ``rows`` of all arrays.
    """

    def __init__(self, rows: Sequence[N_co], strands: Sequence[Strand]) -> None:
        self._rows = rows
        self.strands = strands
        self._starts = [0, *accumulate(strand.length for strand in strands)]

    def __len__(self) -> int:
        return self._starts[-1]

    @property
    def are_known(self) -> bool:
        """Whether anything is known of elements that follow one another."""
        return len(self.strands) < len(self)

    def __getitem__(self, position: int) -> N_co:
        number = bisect_right(self._starts, position) - 1
        strand = self.strands[number]
        return self._rows[strand.start + strand.distance * (position - self._starts[number])]

    def __iter__(self) -> Iterator[N_co]:
        return chain.from_iterable(self.parts())

    def known_from(self, position: int) -> int:
        """The number of elements from a position on of which each is known to differ from the one before in numbers
        that count by the same steps.
        """
        return self._starts[bisect_right(self._starts, position)] - position

    def parts(self) -> Iterator[Sequence[N_co]]:
        """The elements of each strand."""
        return (strand.of(self._rows) for strand in self.strands)


def arrays_of(rows: Sequence[N]) -> dict[str, Elements[N]]:
    """The elements of each array of which there are all from 0 on, by what their names have in common."""
    found: dict[str, dict[int, Strand]] = {}
    for strand in strands(rows):
        for (base, index), part in _with_consecutive_indexes(rows, strand):
            found.setdefault(base, {})[index] = part
    arrays: dict[str, Elements[N]] = {}
    for base, parts in found.items():
        ordered = [parts[index] for index in sorted(parts)]
        if [*accumulate((part.length for part in ordered[:-1]), initial=0)] == sorted(parts):
            arrays[base] = Elements(rows, ordered)
    return arrays


def _with_consecutive_indexes(rows: Sequence[Named], strand: Strand) -> Sequence[tuple[tuple[str, int], Strand]]:
    """The parts of a strand of which the index counts by one, each with the place of its first element."""
    place = indexed(rows[strand.start].name)
    if place is None:
        return ()
    if strand.length == 1:
        return ((place, strand),)
    second = indexed(rows[strand.start + strand.distance].name)
    if second == (place[0], place[1] + 1):
        return ((place, strand),)
    positions = range(strand.start, strand.start + strand.distance * strand.length, strand.distance)
    places = [(indexed(rows[position].name), Strand(position, 1, 1)) for position in positions]
    return [(found, single) for found, single in places if found is not None]


class Arrays:
    """Rows in groups (channels, instances), each with the kind of a row; an array has all elements from 0 on in one
    group, and all of one kind. No array has a name that is ``taken``.
    """

    def __init__(self, *groups: tuple[Sequence[Any], Callable[[Any], Hashable]], taken: Collection[str] = ()) -> None:
        self._places: dict[str, tuple[str, int]] = {}
        self._arrays: dict[str, Elements[Named]] = {}
        for rows, kind in groups:
            self._add(rows, kind)
        for rows, kind in groups:
            kinds = {row.name: kind(row) for row in examples(rows) if "[" not in row.name}
            if len(kinds) >= MANY:
                others = {*taken, *self._arrays, *(row.name for rows, _ in groups for row in rows)}
                places = {row.name: at for at, row in enumerate(rows)}
                for base, names in numbered_lines(kinds, others).items():
                    self._add_array(base, Elements(rows, [Strand(places[name], 1, 1) for name in names]))

    def _add(self, rows: Sequence[N], kind: Callable[[N], Hashable]) -> None:
        names = {row.name for row in examples(rows)}
        for base, elements in arrays_of(rows).items():
            if base not in names and len({kind(row) for row in _first_two(elements)}) == 1:
                self._add_array(base, elements)

    def _add_array(self, base: str, elements: Elements[Named]) -> None:
        self._arrays[base] = elements
        if not elements.are_known:
            self._places.update({row.name: (base, index) for index, row in enumerate(elements)})

    def place(self, name: str) -> tuple[str, int | None]:
        """The array and the index, or the name itself and None."""
        found = self._places.get(name)
        if found is None:
            found = indexed(name) if "[" in name else None
            elements = None if found is None else self._arrays.get(found[0])
            if found is None or elements is None or not elements.are_known or found[1] >= len(elements):
                return name, None
            return found if elements[found[1]].name == name else (name, None)
        return found

    def element(self, base: str, index: int) -> str:
        """The name of an element of an array."""
        return self._arrays[base][index].name

    def known_from(self, base: str, index: int) -> int:
        """The number of elements of an array from an index on of which each is known to differ from the one before in
        numbers that count by the same steps.
        """
        return self._arrays[base].known_from(index)

    def base(self, name: str) -> str:
        """The name of the array, or the name itself."""
        return self.place(name)[0]

    def size(self, name: str) -> int | None:
        """The number of elements of the array that contains an element."""
        base, index = self.place(name)
        return None if index is None else len(self._arrays[base])


def _first_two(elements: Elements[N]) -> Iterator[N]:
    """The first two of all elements that are known to differ in numbers that count: if these are equal, all are."""
    for part in elements.parts():
        yield from part[:2]


def indexed(name: str) -> tuple[str, int] | None:
    """``cell[3]`` and ``cell[3].out`` as (``cell``, 3) and (``cell.out``, 3); None unless there is exactly
    one index.
    """
    base, _, rest = name.partition("[")
    number, _, after = rest.partition("]")
    return (base + after, int(number)) if number.isdecimal() and "[" not in after else None


def numbered_lines(kinds: Mapping[str, Hashable], taken: Collection[str]) -> dict[str, Sequence[str]]:
    """Many names of one kind that are numbered from 0 on in this order, by what they have in common: ``cell`` for
    ``cell0`` and ``cell.out`` for ``cell0.out``, if it is not ``taken``.
    """
    if len(kinds) < MANY:
        return {}
    found: dict[str, list[str]] = {}
    for name in kinds:
        if "[" in name:
            continue
        base, times = _NUMBER.subn("", name)
        if times == 1:
            found.setdefault(base, []).append(name)
    return {
        base: names
        for base, names in found.items()
        if len(names) >= MANY and base not in taken and len({kinds[name] for name in names}) == 1
        if all(_with_number(base, names[0], number) == name for number, name in enumerate(names))
    }


def _with_number(base: str, first: str, number: int) -> str:
    """The name with a number, where that of ``first`` is."""
    place = next((at for at, (a, b) in enumerate(zip(base, first, strict=False)) if a != b), len(base))
    return f"{base[:place]}{number}{base[place:]}"
