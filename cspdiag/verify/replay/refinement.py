"""Whether the run of a replay does what a specification forbids: proofs leave values open, but a run has them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from cspdiag.model.types import Type
from cspdiag.network.dump.expression import value_text
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.answers.question import Question
from cspdiag.proofs.refine.allowed import RunEnd, violation
from cspdiag.proofs.refine.labels import Label, Labels
from cspdiag.proofs.transitions.classes.distinguished import Distinction, Distinguished
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.transitions.values import MOST_VALUES
from cspdiag.proofs.verdict import Limits
from cspdiag.verify.replay.rest import Resting
from cspdiag.verify.replay.result import Judge

if TYPE_CHECKING:
    from cspdiag.network.ir.expressions import Value


def _text(value: Any, kind: Type) -> str:
    """A value as transition systems write it; zero is the same value with either sign."""
    return value_text(value + 0.0 if isinstance(value, float) else value, kind)


def judge(
    question: Question, specified: Callable[[Distinguished], System], network: CoreNetwork, limits: Limits
) -> Judge:
    """A judge that says how a run does not refine the specification, which is followed with exactly the values that the
    environment gave. The judge raises LimitError when the limits are reached.
    """
    hidden = Labels(System((), ()), question.unseen)
    ports = {port.name: port.type for port in network.external_ports if not hidden.hides(port.name)}
    inputs = {port.name for port in network.external_ports if port.direction == "in" and port.name in ports}
    followed = specified({}).distinctions

    def judged(communications: Sequence[tuple[str, Any]], rest: Resting | None) -> str | None:
        seen = [(name, value) for channel, value in communications if (name := channel.partition(".")[2]) in ports]
        specification = specified(_given([(name, value) for name, value in seen if name in followed]))
        labels = Labels(specification, question.unseen)
        texts = [(name, _text(value, ports[name])) for name, value in seen]
        trace = (labels.of_value(name, text) if name in inputs else (name, text) for name, text in texts)
        stands = RunEnd(rest is None, _offers(labels, ports, rest))
        return violation(specification, labels, trace, stands, limits, failures=question.model == "failures")

    return judged


def _given(communications: Sequence[tuple[str, Any]]) -> Distinguished:
    """The values that inputs had."""
    found: dict[str, dict[Value, None]] = {}
    for name, value in communications:
        found.setdefault(name, {})[_plain(value)] = None
    return {name: Distinction(values=tuple(values)) for name, values in found.items() if len(values) <= MOST_VALUES}


def _plain(value: Any) -> Value:
    """A value of a running program as proofs have it."""
    if isinstance(value, tuple | list):
        return tuple(map(_plain, value))
    if isinstance(value, int) and not isinstance(value, bool):
        return int(value)
    plain: Value = value + 0.0 if isinstance(value, float) else value
    return plain


def _offers(labels: Labels, types: Mapping[str, Type], rest: Resting | None) -> frozenset[Label] | None:
    """What the processes offer visibly to the specification; None if they can continue invisibly."""
    if rest is None or rest.can_continue:
        return None
    names = [(option, option.channel.partition(".")[2]) for option in rest.offers]
    if any(name not in types for _, name in names):
        return None
    return frozenset(
        labels.of_value(name, _text(option.value, types[name])) if option.action == "write" else (name, None)
        for option, name in names
    )
