"""Alarms: an interrupt sees that its guard is ready and abandons its body before the communication of the guard takes
place.

If the offer of the other process is withdrawn in between, the interrupt can only wait for its guard. An offer is
withdrawn if an alternative takes another guard, if the process is cancelled or interrupted where it waits, or if on an
``any`` channel another process is faster.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from typing import TypeAlias, assert_never

from cspdiag.proofs.transitions.occurrences import MediumFacts
from cspdiag.proofs.transitions.systems.labels import (
    Alarm,
    Bind,
    Bound,
    Guarded,
    Label,
    Offer,
    OnMedium,
    Read,
    Side,
    Withdrawn,
    Write,
)
from cspdiag.proofs.transitions.systems.references import Reference
from cspdiag.proofs.transitions.systems.template import Template
from cspdiag.proofs.transitions.threads.thread import resolve
from cspdiag.proofs.transitions.threads.threads import ThreadInstance

Special: TypeAlias = Alarm | Guarded | Bind | Bound | Read
"""Labels of guards that another process sees or chooses; of reads only the late ones."""


class Alarms:
    """What threads can see of each other's guards: which alarms can ring, and which late reads an alternative may
    choose.
    """

    def __init__(self, threads: Iterable[ThreadInstance]) -> None:
        watching: list[tuple[ThreadInstance, Special]] = []
        rung: defaultdict[MediumFacts, set[Side]] = defaultdict(set)
        choosing: defaultdict[type[Special], set[MediumFacts]] = defaultdict(set)
        labels_of: dict[int, tuple[set[Special], set[Offer]]] = {}
        for thread in threads:
            template = thread.template
            if id(template) not in labels_of:
                labels_of[id(template)] = _special(template), set[Offer]().union(*withdrawn(template.edges))
            special, unsteady = labels_of[id(template)]
            for offer in unsteady:
                rung[resolve(thread.occurrence, offer.reference)].add(side_of(offer))
            for label in special:
                choosing[type(label)].add(resolve(thread.occurrence, label.reference))
                if not isinstance(label, Guarded):
                    watching.append((thread, label))
        self._silent: defaultdict[ThreadInstance, set[Special]] = defaultdict(set)
        for thread, label in watching:
            medium = resolve(thread.occurrence, label.reference)
            match label:
                case Alarm():
                    rings = medium.is_contended or label.side in rung[medium]
                case Read():
                    rings = medium in choosing[Guarded]
                case Bound():
                    rings = medium in choosing[Bind]
                case Bind():
                    rings = medium in choosing[Bound]
                case Guarded():
                    raise AssertionError("guards that write are not watched")
                case _:
                    assert_never(label)
            if not rings:
                self._silent[thread].add(label)

    def silent(self, thread: ThreadInstance) -> frozenset[Label]:
        """The labels of a thread that never happen: alarms that no offer rings, and communications with alternatives
        that do not exist.
        """
        return frozenset(self._silent.get(thread, ()))


def _special(template: Template) -> set[Special]:
    """The alarms, late reads, output guards and bindings of a thread."""
    labels = {label for edges in template.edges for label, _ in edges}
    guards = {label for label in labels if isinstance(label, Alarm | Guarded | Bind | Bound)}
    return guards | {label for label in labels if isinstance(label, Read) and label.late}


def withdrawn(edges: Sequence[Sequence[tuple[Label, int]]]) -> list[set[Offer]]:
    """For each state of a thread, the labels of offers that another edge out of the state withdraws."""
    offers = [{_offer(label): label for label, _ in found if isinstance(label, Offer)} for found in edges]
    result: list[set[Offer]] = []
    for found, own in zip(edges, offers, strict=True):
        left = [(_offer(label) if isinstance(label, Offer) else None, offers[target]) for label, target in found]
        lost = {offer for offer in own if any(other != offer and offer not in after for other, after in left)}
        result.append(
            {
                label
                for label, _ in found
                if isinstance(label, Offer) and (isinstance(label, Withdrawn) or _offer(label) in lost)
            }
        )
    return result


def _offer(label: Offer) -> tuple[Side, Reference]:
    """The identity of an offer, whatever its value: the side and the medium."""
    return side_of(label), label.reference


def bindings(
    uses: Sequence[tuple[ThreadInstance, OnMedium]],
) -> Iterator[tuple[tuple[ThreadInstance, Bind], tuple[ThreadInstance, Bound]]]:
    """Pairs of an alternative that chooses to write and a ready guard that is bound to read."""
    writers = [(thread, label) for thread, label in uses if isinstance(label, Bind)]
    readers = [(thread, label) for thread, label in uses if isinstance(label, Bound)]
    for writer, reader in product(writers, readers):
        if writer[0] is not reader[0]:
            yield writer, reader


def side_of(label: Offer) -> Side:
    """The side of the medium on which an offer communicates."""
    match label:
        case Read():
            return "read"
        case Write() | Guarded() | Withdrawn():
            return "write"
        case _:
            assert_never(label)
