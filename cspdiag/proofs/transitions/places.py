"""Descriptions of the states of a thread, in the words of the diagram."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cspdiag.proofs.transitions.systems.references import Constant, Discard
from cspdiag.proofs.transitions.systems.system import Place
from cspdiag.proofs.transitions.systems.template import Spot
from cspdiag.proofs.transitions.threads.thread import resolve
from cspdiag.proofs.transitions.threads.threads import Strand


class Places(Mapping[int, Place]):
    """The places of a thread by state, put into words when they are looked up."""

    def __init__(self, spots: list[Spot], strand: Strand) -> None:
        self._spots = spots
        self._strand = strand

    def __getitem__(self, state: int) -> Place:
        if not 0 <= state < len(self._spots):
            raise KeyError(state)
        spot = self._spots[state]
        path = ".".join((self._strand.occurrence.path, *spot.path))
        if spot.reference is None or isinstance(spot.reference, Constant | Discard):
            return Place(spot.words, spot.span, path)
        medium = resolve(self._strand.occurrence, spot.reference)
        return Place(f"{spot.words} {_short(medium.name)}", spot.span, path)

    def __iter__(self) -> Iterator[int]:
        return iter(range(len(self._spots)))

    def __len__(self) -> int:
        return len(self._spots)


def _short(name: str) -> str:
    """A hierarchical name without the outermost process."""
    return name.split(".", 1)[-1]
