"""Whether a specification allows one run, with the values that the run really had.

Proofs leave some values open, and may then find that a process violates its specification; a run of the process shows
whether it does.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cspdiag.base.record import record
from cspdiag.proofs.refine.labels import END, Label, Labels
from cspdiag.proofs.refine.normal_form import State, Walk, smallest
from cspdiag.proofs.refine.words import ended_too_soon, forbidden_event, forbidden_refusal
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import Limits


@record
class RunEnd:
    """The state at the end of a run: whether all processes have ``ended``, and what they ``offer`` otherwise; None if
    they continue by themselves, and so refuse nothing.
    """

    ended: bool
    offers: frozenset[Label] | None = None


def violation(
    specification: System, labels: Labels, trace: Iterable[Label], rest: RunEnd, limits: Limits, *, failures: bool
) -> str | None:
    """How a run does what the specification forbids or, with ``failures``, refuses what the specification demands; None
    if it does neither. Raises LimitError.
    """
    own = {
        number: label for number, event in enumerate(specification.events) if (label := labels.of(event)) is not None
    }
    walk = Walk(specification, own)
    states = walk.closure([specification.initial], limits)
    for label in trace:
        reached = walk.closure(walk.after(states, label), limits)
        if not reached:
            return forbidden_event(label, _allowed(walk, states, labels))
        states = reached
    resting = [walk.offers(state) for state in states if walk.is_stable(state)]
    if rest.ended:
        return None if any(END in offered for offered in resting) else ended_too_soon(_allowed(walk, states, labels))
    acceptances = smallest(resting)
    if not failures or rest.offers is None or _offers_enough(rest.offers, acceptances):
        return None
    return forbidden_refusal(rest.offers, acceptances)


def _allowed(walk: Walk, states: Iterable[State], labels: Labels) -> frozenset[Label]:
    """The labels that may follow; for inputs any value, not only those of this run."""
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
    """Whether a label with any value is matched by an offer at its port."""
    return label[1] is None and any(port == label[0] for port, _ in offers)
