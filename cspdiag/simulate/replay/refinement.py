"""Whether the run of a replay does what a specification forbids: proofs leave values open, a run has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

from cspdiag.analyses.proofs.allowed import Rest, violation
from cspdiag.analyses.proofs.labels import Label, Labels
from cspdiag.analyses.proofs.verdict import Limits
from cspdiag.analyses.transitions.ranges import limits_of, told
from cspdiag.analyses.transitions.system import System
from cspdiag.analyses.verification.question import Question
from cspdiag.model.types import Type
from cspdiag.network.ir import Network
from cspdiag.simulate.replay.rest import Resting
from cspdiag.simulate.replay.result import Judge
from cspdiag.simulate.replay.values import written

_Told: TypeAlias = "tuple[Type, frozenset[int] | None]"
"""The type of a port, and where the specification cuts its numbers."""


def _text(value: Any, kind: Type, boundaries: frozenset[int] | None) -> str:
    """A value as the specification tells it; zero is the same value with either sign."""
    if boundaries is not None and limits_of(kind) is not None:
        return told(value, kind, boundaries)
    return written(value + 0.0 if isinstance(value, float) else value, kind)


def judge(question: Question, specification: System, network: Network, limits: Limits) -> Judge:
    """Says how a run does not refine the specification; it raises LimitError when the limits are reached."""
    labels = Labels(specification, question.hidden)
    ports = {port.name: port.type for port in network.external_ports if not labels.hides(port.name)}
    types = {name: (kind, specification.boundaries.get(name)) for name, kind in ports.items()}

    def judged(communications: Sequence[tuple[str, Any]], rest: Resting | None) -> str | None:
        trace = (
            labels.of_value(name, _text(value, *types[name]))
            for channel, value in communications
            if (name := channel.partition(".")[2]) in types
        )
        stands = Rest(rest is None, _offers(labels, types, rest))
        return violation(specification, labels, trace, stands, limits, failures=question.model == "failures")

    return judged


def _offers(labels: Labels, types: Mapping[str, _Told], rest: Resting | None) -> frozenset[Label] | None:
    """What the processes offer where the specification sees it; None where they can go on unseen."""
    if rest is None or rest.goes_on:
        return None
    names = [(option, option.channel.partition(".")[2]) for option in rest.offers]
    if any(name not in types for _, name in names):
        return None
    return frozenset(
        labels.of_value(name, _text(option.value, *types[name])) if option.action == "write" else (name, None)
        for option, name in names
    )
