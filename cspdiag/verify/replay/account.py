"""The values of a run told in the counterexample that it followed: proofs leave them open, people want to see them."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from typing import Any

from cspdiag.base.record import replaced
from cspdiag.model.types import Type
from cspdiag.network.dump.expression import value_text
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Step
from cspdiag.verify.replay.result import Replay
from cspdiag.verify.runs.agreement import PASSING, agrees, differing
from cspdiag.verify.runs.values import types_of

LONGEST = 24
"""Longer texts of values are left out."""


def with_values(found: Counterexample, replay: Replay, network: CoreNetwork) -> Counterexample:
    """The counterexample with the values that the environment offered, and those of the communications in their order,
    where it has none itself or a range.

    Left open stay other channels on which the run communicated more or less often than the counterexample says, as on
    those with several readers of each value; a value that the run did not have there is left open, too.
    """
    every = (*found.steps, *found.cycle)
    times = Counter(step.channel for step in every if step.kind in PASSING)
    types = {net.path: net.type for net in network.nets if net.path in times}
    happened = defaultdict(list)
    for channel, value in replay.communications:
        if channel in types:
            happened[channel].append(value)
    values = {channel: iter(told) for channel, told in happened.items() if len(told) == times[channel]}
    steps = [_told(_offered(step, replay.offered.get(number)), values, types) for number, step in enumerate(every)]
    unlike = {steps[number].channel for number in differing(steps, replay.communications, types_of(network))}
    steps = [replaced(step, value=None) if step.channel in unlike else step for step in steps]
    return replaced(found, steps=tuple(steps[: len(found.steps)]), cycle=tuple(steps[len(found.steps) :]))


def _offered(step: Step, text: str | None) -> Step:
    return step if text is None or len(text) > LONGEST else replaced(step, value=text)


def _told(step: Step, values: Mapping[str, Iterator[Any]], types: Mapping[str, Type]) -> Step:
    if step.kind not in PASSING or step.channel not in values:
        return step
    value = next(values[step.channel])
    text = value_text(value, types[step.channel])
    if len(text) <= LONGEST:
        return replaced(step, value=text)
    return step if agrees(value, types[step.channel], step.value) else replaced(step, value=None)
