"""Where else to look when the program does not follow a counterexample: in a part of the behaviour that the proof
assumes.

Proofs leave out times and priorities, so in them a sample may be missed although no process computes, and a delay may
end too soon. What most often leads to wrong counterexamples is left out first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TypeAlias

from cspdiag.base.record import replaced
from cspdiag.network.dump.delay import is_of_time_out
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Step
from cspdiag.proofs.transitions.systems.restricted import is_time_out, with_maximal_progress, without
from cspdiag.proofs.transitions.systems.system import Event, System

Narrowing: TypeAlias = Callable[[System], System]

MOST = 5
"""The maximum number of other counterexamples that are searched for."""


def narrower(found: Counterexample) -> Iterator[Narrowing]:
    """Narrower systems in which to look, one after the other; none of them has the whole counterexample."""
    steps = (*found.steps, *found.cycle)
    has_misses = any(step.kind == "miss" for step in steps)
    has_time_outs = any(step.kind == "time" and is_of_time_out(step.channel) for step in steps)
    if has_misses or has_time_outs:
        yield lambda system: with_maximal_progress(without(system, _is_miss))
    if has_misses:
        yield partial(without, is_left_out=_is_miss)
    if has_time_outs:
        yield partial(without, is_left_out=is_time_out)
    if found.failure != "refinement":
        # Without its communications a process gets stuck that otherwise does not.
        return
    known: set[tuple[str, str, str | None]] = set()
    for step in reversed(steps):
        key = (step.kind, step.channel, step.value)
        if step.kind in {"communication", "external", "sample", "time"} and key not in known:
            known.add(key)
            yield partial(without, is_left_out=partial(_is_same, step))


def in_whole_system(found: Counterexample, whole: System) -> Counterexample:
    """A counterexample of a narrower system, with the parties that its time-outs have in the whole system."""
    owners = {
        (event.channel, whole.components[party].name)
        for event in whole.events
        if is_time_out(event)
        for party in event.parties
    }
    prefix = f"{found.process}."

    def with_parties(step: Step) -> Step:
        if step.kind != "time":
            return step
        own = [party for party in step.parties if _is_owner(step.channel, party.name, owners, prefix)]
        return replaced(step, parties=tuple(own) or step.parties[:1])

    return replaced(found, steps=tuple(map(with_parties, found.steps)), cycle=tuple(map(with_parties, found.cycle)))


def _is_owner(channel: str, name: str, owners: set[tuple[str, str]], prefix: str) -> bool:
    return (channel, name) in owners or (channel, f"{prefix}{name}") in owners


def _is_miss(event: Event) -> bool:
    return event.kind == "miss"


def _is_same(step: Step, event: Event) -> bool:
    return (event.kind, event.channel, event.value) == (step.kind, step.channel, step.value)
