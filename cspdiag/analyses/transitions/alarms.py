"""Alarms: an interrupt sees that its guard is ready and abandons its body, but the communication of the guard is not made yet.

If the offer is withdrawn before it is made, only the guard is left to wait for. An offer can be withdrawn by an alternative that takes another guard, a
process that is cancelled or interrupted where it waits, and on ``any`` by somebody who is faster.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

from cspdiag.analyses.transitions.occurrences import Medium
from cspdiag.analyses.transitions.template import Label, Reference, Template
from cspdiag.analyses.transitions.thread import resolve
from cspdiag.analyses.transitions.threads import Strand

_OFFERS = frozenset({"read", "write", "guarded", "withdrawn"})


class Alarms:
    """Which threads can see a guard ready in vain: those with an ``alarm`` on a medium where an offer of the other side may be withdrawn."""

    def __init__(self, threads: Iterable[Strand]) -> None:
        watchers: list[tuple[Strand, Label]] = []
        rung: defaultdict[Medium, set[str]] = defaultdict(set)
        unsteady: dict[int, set[Label]] = {}
        for strand in threads:
            template = strand.template
            if id(template) not in unsteady:
                unsteady[id(template)] = _unsteady(template)
            for label in unsteady[id(template)]:
                if label[0] == "alarm":
                    watchers.append((strand, label))
                else:
                    rung[resolve(strand.occurrence, label[1])].add(_side(label))
        self._silent: defaultdict[Strand, set[Label]] = defaultdict(set)
        for strand, label in watchers:
            medium = resolve(strand.occurrence, label[1])
            if not medium.is_contended and label[2] not in rung[medium]:
                self._silent[strand].add(label)

    def silent(self, strand: Strand) -> frozenset[Label]:
        """The alarms of a thread that nobody ever rings."""
        return frozenset(self._silent.get(strand, ()))


def _unsteady(template: Template) -> set[Label]:
    """The alarms of a thread, and its offers that it may withdraw."""
    alarms = {label for edges in template.edges for label, _ in edges if label[0] == "alarm"}
    return alarms.union(*withdrawn(template.edges))


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
