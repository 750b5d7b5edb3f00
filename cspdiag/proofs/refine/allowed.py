"""What a specification says of one run, with the values that it really had.

Proofs leave values open, and then a process seems to do what its specification forbids. Its run says whether it does.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cspdiag.base.record import record
from cspdiag.proofs.refine.labels import END, Label, Labels
from cspdiag.proofs.refine.normal_form import State, Walk, smallest
from cspdiag.proofs.refine.words import done_too_much, ended_too_soon, refused_too_much
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import Limits


@record
class Rest:
    """How a run stands in the end: whether all has ``ended``, and otherwise what it ``offers``; None where it still
    goes on by itself, so that it refuses nothing.
    """

    ended: bool
    offers: frozenset[Label] | None = None


def violation(
    specification: System, labels: Labels, trace: Iterable[Label], rest: Rest, limits: Limits, *, failures: bool
) -> str | None:
    """How a run does what the specification forbids or, if asked for ``failures``, refuses what it demands; None if it
    does not. Raises LimitError.
    """
    own = {
        number: label for number, event in enumerate(specification.events) if (label := labels.of(event)) is not None
    }
    walk = Walk(specification, own)
    states = walk.closure([specification.initial], limits)
    for label in trace:
        reached = walk.closure(walk.after(states, label), limits)
        if not reached:
            return done_too_much(label, _allowed(walk, states, labels))
        states = reached
    resting = [walk.offers(state) for state in states if walk.is_stable(state)]
    if rest.ended:
        return None if any(END in offered for offered in resting) else ended_too_soon(_allowed(walk, states, labels))
    acceptances = smallest(resting)
    if not failures or rest.offers is None or _offers_enough(rest.offers, acceptances):
        return None
    return refused_too_much(rest.offers, acceptances)


def _allowed(walk: Walk, states: Iterable[State], labels: Labels) -> frozenset[Label]:
    """What may come next: of inputs not only the values of this run."""
    apart = labels.specification.distinctions
    return frozenset(
        (port, None) if port in apart and apart[port].values else (port, value)
        for state in states
        for port, value in walk.offers(state)
    )


def _offers_enough(offers: frozenset[Label], acceptances: Sequence[frozenset[Label]]) -> bool:
    ports = {port for port, value in offers if value is None}
    return any(
        all(label[0] in ports or label in offers or _any_of(label, offers) for label in accepted)
        for accepted in acceptances
    )


def _any_of(label: Label, offers: frozenset[Label]) -> bool:
    """Whether a specification that takes any value at a port is offered one."""
    return label[1] is None and any(port == label[0] for port, _ in offers)
