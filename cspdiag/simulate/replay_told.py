"""The values of a run told in the counterexample that it followed: proofs leave them open, people want to see them."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from cspdiag.analyses.counterexamples.counterexample import Counterexample, Step
from cspdiag.network.dump_expression import value_text
from cspdiag.network.ir import Network

LONGEST = 24
"""Longer texts of values are left out."""
_TOLD = frozenset({"communication", "external", "sample"})


def with_values(found: Counterexample, communications: Sequence[tuple[str, Any]], network: Network) -> Counterexample:
    """The counterexample with the values of ``communications``, in their order, where it has none itself or a range.

    Left open stay channels on which the run communicated more or less often than the counterexample says, as on those with several readers of each value.
    """
    steps = Counter(step.channel for step in (*found.steps, *found.cycle) if step.kind in _TOLD)
    types = {net.path: net.type for net in network.nets if net.path in steps}
    happened = defaultdict(list)
    for channel, value in communications:
        if channel in types:
            happened[channel].append(value_text(value, types[channel]))
    values = {channel: iter(told) for channel, told in happened.items() if len(told) == steps[channel]}
    return replace(
        found,
        steps=tuple(_told(step, values) for step in found.steps),
        cycle=tuple(_told(step, values) for step in found.cycle),
    )


def _told(step: Step, values: Mapping[str, Iterator[str]]) -> Step:
    if step.kind not in _TOLD or step.channel not in values:
        return step
    text = next(values[step.channel])
    return step if len(text) > LONGEST else replace(step, value=text)
