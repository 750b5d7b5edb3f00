"""Alarms: an interrupt sees that its guard is ready and abandons its body, but the communication of the guard is not made yet.

If the offer is withdrawn before it is made, only the guard is left to wait for. An offer can be withdrawn by an alternative that takes another guard, a
process that is cancelled or interrupted where it waits, and on ``any`` by somebody who is faster.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from itertools import product

from cspdiag.proofs.transitions.occurrences import Medium
from cspdiag.proofs.transitions.systems.template import Label, Reference, Template, is_late
from cspdiag.proofs.transitions.threads.thread import resolve
from cspdiag.proofs.transitions.threads.threads import Strand

_CHOOSING = {"read": "guarded", "bound": "bind", "bind": "bound"}
"""What the other side of a label is that takes an alternative."""
_OFFERS = frozenset({"read", "write", "guarded", "withdrawn"})


class Alarms:
    """What threads can see of each other's guards: which of the ``alarm`` labels ring, and which late reads some alternative may choose."""

    def __init__(self, threads: Iterable[Strand]) -> None:
        watching: list[tuple[Strand, Label]] = []
        rung: defaultdict[Medium, set[str | None]] = defaultdict(set)
        choosing: defaultdict[str, set[Medium]] = defaultdict(set)
        labels_of: dict[int, tuple[set[Label], set[Label]]] = {}
        for strand in threads:
            template = strand.template
            if id(template) not in labels_of:
                labels_of[id(template)] = _special(template), set().union(*withdrawn(template.edges))
            special, unsteady = labels_of[id(template)]
            for label in unsteady:
                rung[resolve(strand.occurrence, label[1])].add(side_of(label))
            for label in special:
                choosing[label[0]].add(resolve(strand.occurrence, label[1]))
                if label[0] != "guarded":
                    watching.append((strand, label))
        self._silent: defaultdict[Strand, set[Label]] = defaultdict(set)
        for strand, label in watching:
            medium = resolve(strand.occurrence, label[1])
            if label[0] == "alarm":
                rings = medium.is_contended or label[2] in rung[medium]
            else:
                rings = medium in choosing[_CHOOSING[label[0]]]
            if not rings:
                self._silent[strand].add(label)

    def silent(self, strand: Strand) -> frozenset[Label]:
        """The alarms of a thread that nobody ever rings, and what it would do with an alternative that there is not."""
        return frozenset(self._silent.get(strand, ()))


def _special(template: Template) -> set[Label]:
    """The alarms of a thread, its late reads, the guards by which it writes, and the ways to be bound to write or read."""
    labels = {label for edges in template.edges for label, _ in edges}
    return {label for label in labels if label[0] in ("alarm", "guarded", "bind", "bound") or is_late(label)}


def withdrawn(edges: Sequence[Sequence[tuple[Label, int]]]) -> list[set[Label]]:
    """For each state of a thread the labels of offers that are not made any more after something else has happened."""
    offers = [{_offer(label): label for label, _ in found if label[0] in _OFFERS} for found in edges]
    result: list[set[Label]] = []
    for found, own in zip(edges, offers, strict=True):
        left = [(_offer(label), offers[target]) for label, target in found]
        lost = {offer for offer in own if any(other != offer and offer not in after for other, after in left)}
        result.append({label for label, _ in found if label[0] == "withdrawn" or _offer(label) in lost})
    return result


def _offer(label: Label) -> tuple[str | None, Reference] | None:
    """What an offer is, whatever its value: the side, and the medium."""
    return (side_of(label), label[1]) if label[0] in _OFFERS else None


def bindings(
    uses: Sequence[tuple[Strand, Label]],
) -> Iterator[tuple[tuple[Strand, Label], tuple[Strand, Label]]]:
    """Alternatives that choose to write, each with a guard that is ready to be read after."""
    for writer, reader in product(uses, repeat=2):
        if (writer[1][0], reader[1][0]) == ("bind", "bound") and writer[0] is not reader[0]:
            yield writer, reader


def side_of(label: Label) -> str | None:
    """The side on which a label communicates, ``read`` or ``write``; None if it does not."""
    if label[0] not in _OFFERS:
        return None
    return "read" if label[0] == "read" else "write"
