"""Alarms: an interrupt sees that its guard is ready and abandons its body, but the communication of the guard is not made yet.

If the offer is withdrawn before it is made, only the guard is left to wait for. An offer can be withdrawn by an alternative that takes another guard, a
process that is cancelled or interrupted where it waits, and on ``any`` by somebody who is faster.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

from cspdiag.analyses.transitions.occurrences import Medium
from cspdiag.analyses.transitions.template import Label, Reference, Template, is_late
from cspdiag.analyses.transitions.thread import resolve
from cspdiag.analyses.transitions.threads import Strand

_OFFERS = frozenset({"read", "write", "guarded", "withdrawn"})


class Alarms:
    """What threads can see of each other's guards: which of the ``alarm`` labels ring, and which late reads some alternative may choose."""

    def __init__(self, threads: Iterable[Strand]) -> None:
        watching: list[tuple[Strand, Label]] = []
        rung: defaultdict[Medium, set[str]] = defaultdict(set)
        choosing: set[Medium] = set()
        labels_of: dict[int, tuple[set[Label], set[Label]]] = {}
        for strand in threads:
            template = strand.template
            if id(template) not in labels_of:
                labels_of[id(template)] = _special(template), set().union(*withdrawn(template.edges))
            special, unsteady = labels_of[id(template)]
            for label in unsteady:
                rung[resolve(strand.occurrence, label[1])].add(_side(label))
            for label in special:
                if label[0] == "guarded":
                    choosing.add(resolve(strand.occurrence, label[1]))
                else:
                    watching.append((strand, label))
        self._silent: defaultdict[Strand, set[Label]] = defaultdict(set)
        for strand, label in watching:
            medium = resolve(strand.occurrence, label[1])
            rings = medium in choosing if is_late(label) else medium.is_contended or label[2] in rung[medium]
            if not rings:
                self._silent[strand].add(label)

    def silent(self, strand: Strand) -> frozenset[Label]:
        """The alarms of a thread that nobody ever rings, and its late reads that no alternative chooses."""
        return frozenset(self._silent.get(strand, ()))


def _special(template: Template) -> set[Label]:
    """The alarms of a thread, its late reads, and the guards by which it writes."""
    labels = {label for edges in template.edges for label, _ in edges}
    return {label for label in labels if label[0] in ("alarm", "guarded") or is_late(label)}


def withdrawn(edges: Sequence[Sequence[tuple[Label, int]]]) -> list[set[Label]]:
    """For each state of a thread the labels of offers that are not made any more after something else has happened."""
    offers = [{_offer(label): label for label, _ in found if label[0] in _OFFERS} for found in edges]
    result: list[set[Label]] = []
    for found, own in zip(edges, offers, strict=True):
        left = [(_offer(label), offers[target]) for label, target in found]
        lost = {offer for offer in own if any(other != offer and offer not in after for other, after in left)}
        result.append({label for label, _ in found if label[0] == "withdrawn" or _offer(label) in lost})
    return result


def _offer(label: Label) -> tuple[str, Reference] | None:
    """What an offer is, whatever its value: the side, and the medium."""
    return (_side(label), label[1]) if label[0] in _OFFERS else None


def _side(label: Label) -> str:
    return "read" if label[0] == "read" else "write"
