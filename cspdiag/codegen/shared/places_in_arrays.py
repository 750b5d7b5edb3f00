"""Which of several names are elements of arrays: ``cell[0]``, ``cell[1]``, ..."""

from __future__ import annotations

import re
from collections.abc import Hashable, Mapping


class Arrays:
    """Names in groups (of channels, of instances); an array has all elements from 0 on in one group, and all of one
    kind.
    """

    def __init__(self, *groups: Mapping[str, Hashable]) -> None:
        self._places: dict[str, tuple[str, int]] = {}
        self._sizes: dict[str, int] = {}
        for group in groups:
            self._add(group)

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
    found = re.findall(r"\[(\d+)\]", name)
    if len(found) != 1:
        return None
    return re.sub(r"\[\d+\]", "", name), int(found[0])
