"""Where else to look when the program does not follow a counterexample: without something that is in it.

Proofs leave times and priorities out, so that a sample may be missed although nobody computes, and a delay may end too soon. What is most often
in the way so is left out first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from cspdiag.analyses.counterexamples.counterexample import Counterexample, Step
from cspdiag.analyses.transitions.system import Event

MOST = 4
"""So many others are looked for."""


def narrower(found: Counterexample) -> Iterator[Callable[[Event], bool]]:
    """What to leave out, one after the other; each is in the counterexample."""
    steps = (*found.steps, *found.cycle)
    if any(step.kind == "miss" for step in steps):
        yield _is_miss
    if any(map(_is_time_out, steps)):
        yield _is_time_out
    if found.failure != "refinement":
        # Without its communications a process gets stuck that does not.
        return
    known: set[tuple[str, str, str | None]] = set()
    for step in reversed(steps):
        key = (step.kind, step.channel, step.value)
        if step.kind in {"communication", "external", "sample", "time"} and key not in known:
            known.add(key)
            yield _same_as(step)


def _is_miss(event: Event) -> bool:
    return event.kind == "miss"


def _is_time_out(event: Event | Step) -> bool:
    return event.kind == "time" and event.channel.rpartition(": ")[2].startswith("after")


def _same_as(step: Step) -> Callable[[Event], bool]:
    return lambda event: (event.kind, event.channel, event.value) == (step.kind, step.channel, step.value)
