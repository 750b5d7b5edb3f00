"""Names of the elements of arrays: made only when one is asked for, which few runs do."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice
from typing import Any, Protocol, TypeVar


class Labelled(Protocol):
    """What can be an element: ``label`` is its name, or those of the array."""

    label: str | Names


E = TypeVar("E", bound=Labelled)


class Names:
    """The names of the elements of an array: the number of the element between two texts."""

    __slots__ = ("_after", "_before", "_elements", "_numbers")

    def __init__(self, before: str, after: str, elements: list[Any]) -> None:
        self._before = before
        self._after = after
        self._elements = elements
        self._numbers: dict[int, int] = {}

    def numbered(self, number: int) -> str:
        """The name of the element with this number."""
        return f"{self._before}{number}{self._after}"

    def of(self, element: object) -> str:
        """The name of an element."""
        if not self._numbers:
            self._numbers = {id(each): number for number, each in enumerate(self._elements)}
        return self.numbered(self._numbers[id(element)])


def name_of(element: Labelled) -> str:
    """The name of an element."""
    label = element.label
    return label if isinstance(label, str) else label.of(element)


def numbered(elements: Iterable[E]) -> list[E]:
    """The elements of an array, each made with its name as ``label``, in a list that is not changed any more.

    Those that are named like the first two, ``path[0]`` and ``path[1]`` or ``path[0].end`` and ``path[1].end``, then
    share one object in place of a name of their own.
    """
    coming = iter(elements)
    array = list(islice(coming, 2))
    names = _names_like([element.label for element in array], array)
    for element in array:
        _share(element, array.index(element), names)
    for number, element in enumerate(coming, len(array)):
        _share(element, number, names)
        array.append(element)
    return array


def _share(element: Labelled, number: int, names: Names | None) -> None:
    if names is not None and element.label == names.numbered(number):
        element.label = names


def _names_like(labels: list[Any], array: list[Any]) -> Names | None:
    """Names of which the first two are ``labels``: they differ in their number alone."""
    if len(labels) < 2 or len(labels[0]) != len(labels[1]):
        return None
    different = [place for place, pair in enumerate(zip(*labels, strict=True)) if pair[0] != pair[1]]
    if len(different) != 1:
        return None
    (place,) = different
    names = Names(labels[0][:place], labels[0][place + 1 :], array)
    return names if [names.numbered(0), names.numbered(1)] == labels else None
