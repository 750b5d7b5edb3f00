"""The values of a run told in the counterexample that it followed: proofs leave them open, people want to see them."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import replace

from cspdiag.analyses.counterexamples.counterexample import Counterexample, Step
from cspdiag.network.dump_expression import value_text
from cspdiag.network.ir import Network
from cspdiag.simulate.replay.result import Replay

LONGEST = 24
"""Longer texts of values are left out."""
_TOLD = frozenset({"communication", "external", "sample"})


def with_values(found: Counterexample, replay: Replay, network: Network) -> Counterexample:
    """The counterexample with the values that the environment offered, and those of the communications in their order, where it has none itself or a range.

    Left open stay other channels on which the run communicated more or less often than the counterexample says, as on those with several readers of each value.
    """
    every = (*found.steps, *found.cycle)
    times = Counter(step.channel for step in every if step.kind in _TOLD)
    types = {net.path: net.type for net in network.nets if net.path in times}
    happened = defaultdict(list)
    for channel, value in replay.communications:
        if channel in types:
            happened[channel].append(value_text(value, types[channel]))
    values = {channel: iter(told) for channel, told in happened.items() if len(told) == times[channel]}
    steps = [_told(_offered(step, replay.offered.get(number)), values) for number, step in enumerate(every)]
    return replace(found, steps=tuple(steps[: len(found.steps)]), cycle=tuple(steps[len(found.steps) :]))


def _offered(step: Step, text: str | None) -> Step:
    return step if text is None or len(text) > LONGEST else replace(step, value=text)


def _told(step: Step, values: Mapping[str, Iterator[str]]) -> Step:
    if step.kind not in _TOLD or step.channel not in values:
        return step
    text = next(values[step.channel])
    return step if len(text) > LONGEST else replace(step, value=text)
