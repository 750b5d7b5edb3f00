"""Adds the values of a run to the counterexample that it followed: proofs leave them open, but users want them."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from cspdiag.base.record import replaced
from cspdiag.model.types import Type
from cspdiag.network.dump.expression import value_text
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Step
from cspdiag.proofs.counterexamples.rounds import with_rounds
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.verify.guided.script import Actor
from cspdiag.verify.replay.added_parties import AddedParties
from cspdiag.verify.replay.result import Replay
from cspdiag.verify.replay.rounds import Added
from cspdiag.verify.runs.agreement import PASSING, agrees, differing
from cspdiag.verify.runs.values import types_of

LONGEST = 24
"""The longest text of a value that is shown."""


def as_replayed(found: Counterexample, replay: Replay, network: CoreNetwork, system: System) -> Counterexample:
    """The counterexample of a system with the rounds that the replay has added, with the values at the ports of the
    program, and with those of the communications in their order, where it has itself none or a range.

    The values remain open for other channels on which the run communicated more or less often than the counterexample,
    such as those with several readers of each value, and for steps that the run does not have.
    """
    steps, cycle = (
        tuple(_passed(step, replay.passed.get(number)) for number, step in enumerate(part, start))
        for part, start in ((found.steps, 0), (found.cycle, len(found.steps)))
    )
    parties = AddedParties(system, network.top)
    if replay.added:
        # The trace has as few rounds as possible, so the program may have done a step of it in another place.
        steps = tuple(_where_done(step, replay.actors.get(number, ()), parties) for number, step in enumerate(steps))
    added = ((one.before, _step(one, parties)) for one in replay.added)
    found = with_rounds(replaced(found, steps=steps, cycle=cycle), added)
    every = [*found.steps, *found.cycle]
    times = Counter(step.channel for step in every if step.kind in PASSING)
    types = {net.path: net.type for net in network.nets if net.path in times}
    happened = defaultdict(list)
    for channel, value in replay.communications:
        if channel in types:
            happened[channel].append(value)
    values = {channel: iter(had) for channel, had in happened.items() if len(had) == times[channel]}
    every = [_with_value(step, values, types) for step in every]
    unlike = {every[number].channel for number in differing(every, replay.communications, types_of(network))}
    every = [replaced(step, value=None) if step.channel in unlike else step for step in every]
    return replaced(found, steps=tuple(every[: len(found.steps)]), cycle=tuple(every[len(found.steps) :]))


def _step(added: Added, parties: AddedParties) -> Step:
    """An added step as counterexamples have it."""
    step = added.step
    value = step.value if step.value is None or len(step.value) <= LONGEST else None
    party, channel = parties.of(added)
    return Step(step.kind, channel, value, (party,))  # type: ignore[arg-type]


def _where_done(step: Step, actors: Sequence[Actor], parties: AddedParties) -> Step:
    """A step with the places in which the program did it."""
    return replaced(step, parties=tuple(parties.where_done(step, party, actors) for party in step.parties))


def _passed(step: Step, text: str | None) -> Step:
    return step if text is None or len(text) > LONGEST else replaced(step, value=text)


def _with_value(step: Step, values: Mapping[str, Iterator[Any]], types: Mapping[str, Type]) -> Step:
    if step.kind not in PASSING or step.channel not in values:
        return step
    value = next(values[step.channel])
    text = value_text(value, types[step.channel])
    if len(text) <= LONGEST:
        return replaced(step, value=text)
    return step if agrees(value, types[step.channel], step.value) else replaced(step, value=None)
