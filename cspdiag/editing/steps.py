"""Counterexamples for diagrams: which elements each step concerns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from cspdiag.base.span import Span
from cspdiag.draw.deadlock.marks import StuckProcess, surroundings
from cspdiag.model.program import Program
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Step
from cspdiag.proofs.counterexamples.table import event_text
from cspdiag.verify.deadlock_picture import deadlock_shown_by

MOST_STEPS = 200
"""At most this number of steps is shown: the first, and what they lead to."""


def steps_shown(program: Program, found: Counterexample, network: CoreNetwork | None) -> list[dict[str, Any]]:
    """The steps that diagrams show, and the end, as objects of JSON.

    Each has a ``text``, the ``process`` in whose communication diagram it happens, and the keys of the elements that
    are ``communicating`` or ``waiting``.
    """
    declared = {} if network is None else {net.path: net.span for net in network.nets}
    shown = [step for step in found.steps if step.shown]
    steps = list(_communications(program, found.process, shown[:MOST_STEPS], declared))
    deadlock = deadlock_shown_by(found, network)
    if deadlock is not None:
        waiting = (*deadlock.cycle, *deadlock.besides)
        end = _marked(program, found.process, waiting, declared)
        if end is not None:
            process, keys = end
            words = "; ".join(f"{each.path.partition('.')[2] or each.path} waits {each.words}" for each in waiting)
            steps.append({"process": process, "text": words, "communicating": [], "waiting": keys})
    return steps


def _communications(
    program: Program, top: str, steps: Sequence[Step], declared: Mapping[str, Span]
) -> Iterator[dict[str, Any]]:
    for step in steps:
        channels = (step.channel,) if step.channel else ()
        parties = [
            StuckProcess(party.path or f"{top}.{party.name}", party.words, channels=channels) for party in step.parties
        ]
        place = _marked(program, top, parties, declared) if parties else None
        if place is not None:
            process, keys = place
            alone = f" of {step.parties[0].name}" if len(step.parties) == 1 else ""
            text = f"{event_text(step, top)}{alone}"
            yield {"process": process, "text": text, "communicating": keys, "waiting": []}


def _marked(
    program: Program, top: str, processes: Sequence[StuckProcess], declared: Mapping[str, Span]
) -> tuple[str, list[str]] | None:
    """The process around some others, and the keys of these and of their channels in its diagram."""
    found = surroundings(program, top, processes, declared)
    return None if found is None else (found[0].key, list(found[1]))
