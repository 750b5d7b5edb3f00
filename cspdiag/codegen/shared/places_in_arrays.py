"""Which of several names are elements of arrays: ``cell[0]``, ``cell[1]``, ..., or ``cell0``, ``cell1``, ... where they
are many.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Hashable, Mapping, Sequence

MANY = 100
"""From this number on, lines with numbered names are an array in generated code: nobody reads them one by one."""

NUMBER = r"(?<=[A-Za-z_])(?:0|[1-9][0-9]*)(?=\.|$)"
"""The number at the end of a name or of a part of a path."""

_NUMBER = re.compile(NUMBER)


class Arrays:
    """Names in groups (of channels, of instances); an array has all elements from 0 on in one group, and all of one
    kind. No array has a name that is ``taken``.
    """

    def __init__(self, *groups: Mapping[str, Hashable], taken: Collection[str] = ()) -> None:
        self._places: dict[str, tuple[str, int]] = {}
        self._sizes: dict[str, int] = {}
        for group in groups:
            self._add(group)
        for group in groups:
            others = {*taken, *self._sizes, *(name for group in groups for name in group)}
            for base, elements in numbered_lines(group, others).items():
                self._sizes[base] = len(elements)
                self._places.update({name: (base, index) for index, name in enumerate(elements)})
        self._elements = {place: name for name, place in self._places.items()}

    def _add(self, kinds: Mapping[str, Hashable]) -> None:
        found: dict[str, dict[int, str]] = {}
        for name in kinds:
            place = indexed(name)
            if place is not None:
                found.setdefault(place[0], {})[place[1]] = name
        for base, elements in found.items():
            alike = len({kinds[name] for name in elements.values()}) == 1
            if alike and base not in kinds and sorted(elements) == list(range(len(elements))):
                self._sizes[base] = len(elements)
                self._places.update({name: (base, index) for index, name in elements.items()})

    def place(self, name: str) -> tuple[str, int | None]:
        """The array and the index, or the name itself and None."""
        return self._places.get(name, (name, None))

    def element(self, base: str, index: int) -> str:
        """The name of an element of an array."""
        return self._elements[base, index]

    def base(self, name: str) -> str:
        """The name of the array, or the name itself."""
        return self.place(name)[0]

    def size(self, name: str) -> int | None:
        """The number of elements of the array that contains an element."""
        base, index = self.place(name)
        return None if index is None else self._sizes[base]


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
        base, times = _NUMBER.subn("", name)
        if times == 1 and "[" not in name:
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
