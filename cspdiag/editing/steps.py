"""Counterexamples for diagrams: which elements each step concerns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from cspdiag.base.span import Span
from cspdiag.draw.deadlock.marks import StuckProcess, marks_beside, surroundings
from cspdiag.model.program import Program
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.counterexamples.counterexample import Counterexample
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
    deadlock = deadlock_shown_by(found, network)
    waiting = () if deadlock is None else (*deadlock.cycle, *deadlock.besides)
    steps = list(_communications(program, found, waiting, declared))
    end = surroundings(program, found.process, waiting, declared) if waiting else None
    if end is not None:
        words = "; ".join(f"{each.path.partition('.')[2] or each.path} waits {each.words}" for each in waiting)
        steps.append({"process": end[0].key, "text": words, "communicating": [], "waiting": list(end[1])})
    return steps


def _communications(
    program: Program, found: Counterexample, waiting: Sequence[StuckProcess], declared: Mapping[str, Span]
) -> Iterator[dict[str, Any]]:
    """The steps that are shown; a process waits to the end from the step on that follows its last one."""
    top = found.process
    last = {
        party.path or f"{top}.{party.name}": number for number, step in enumerate(found.steps) for party in step.parties
    }
    shown = [(number, step) for number, step in enumerate(found.steps) if step.shown]
    for number, step in shown[:MOST_STEPS]:
        channels = (step.channel,) if step.channel else ()
        parties = [
            StuckProcess(party.path or f"{top}.{party.name}", party.words, channels=channels) for party in step.parties
        ]
        place = surroundings(program, top, parties, declared) if parties else None
        if place is not None:
            diagram, communicating = place
            already = [each for each in waiting if last.get(each.path, -1) < number]
            alone = f" of {step.parties[0].name}" if len(step.parties) == 1 else ""
            yield {
                "process": diagram.key,
                "text": f"{event_text(step, top)}{alone}",
                "communicating": list(communicating),
                "waiting": [
                    key for key in marks_beside(diagram, parties, already, declared) if key not in communicating
                ],
            }
