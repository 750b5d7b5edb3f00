"""Alarms: an interrupt sees that its guard is ready and abandons its body, but the communication of the guard is not made yet.

If the offer is withdrawn before it is made, only the guard is left to wait for. An offer can be withdrawn by an alternative that takes another guard, a
process that is cancelled or interrupted where it waits, and on ``any`` by somebody who is faster.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

from cspdiag.analyses.transitions.occurrences import Medium
from cspdiag.analyses.transitions.template import Label, Template
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
    found: set[Label] = set()
    for edges in template.edges:
        labels = [label for label, _ in edges]
        found.update(label for label in labels if label[0] == "alarm" or may_be_withdrawn(label, labels))
    return found


def may_be_withdrawn(label: Label, beside: Sequence[Label]) -> bool:
    """Whether a state in which a thread makes an offer, among the labels ``beside`` it, can be left without its communication."""
    if label[0] not in _OFFERS:
        return False
    if label[0] == "withdrawn":
        return True
    own = (_side(label), label[1])
    return any(other[0] not in _OFFERS or (_side(other), other[1]) != own for other in beside)


def _side(label: Label) -> str:
    return "read" if label[0] == "read" else "write"
