"""Counterexamples in sentences: which process waits for which."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from cspdiag.proofs.counterexamples.counterexample import BlockedProcess, Counterexample, Step
from cspdiag.proofs.counterexamples.table import event_text

MOST_OTHERS = 8
MOST_OF_A_RING = 24
MOST_STEPS = 5
"""At most this number of steps of a counterexample is shown in a sentence."""


def supposed_lines(found: Counterexample) -> Iterator[str]:
    """What a counterexample supposes that no run of the program was found to follow: which processes would wait, and
    after which steps.
    """
    if not found.waiting:
        return
    happened = [f"`{event_text(step, found.process)}`{_alone(step)}" for step in found.steps if step.shown]
    if len(happened) > MOST_STEPS:
        yield f"after {len(happened)} steps, the last of them {', '.join(happened[-MOST_STEPS:])}:"
    elif happened:
        yield f"after {', '.join(happened)}:"
    yield from waiting_lines(found, supposed=True)


def _alone(step: Step) -> str:
    """The process of a step, if no other one takes part."""
    return f" of `{step.parties[0].name}`" if len(step.parties) == 1 else ""


def waiting_lines(found: Counterexample, *, supposed: bool = False) -> Iterator[str]:
    """A line for each process that never continues, those that wait for each other first; ``supposed`` if no run was
    found that leads there.
    """
    by_name = {entry.name: entry for entry in found.waiting}
    following = (*found.ring[1:], *found.ring[:1])
    left_out = range(MOST_OF_A_RING - 2, len(found.ring) - 2)
    for number, (name, partner) in enumerate(zip(found.ring, following, strict=True)):
        if number not in left_out:
            yield f"{_explained(by_name[name])}, for `{partner}`"
        elif number == left_out.start:
            yield f"... {len(left_out)} more ..."
    others = [entry for entry in found.waiting if entry.name not in found.ring]
    for entry in others[:MOST_OTHERS]:
        partners = listed(entry.partners[:MOST_OTHERS])
        if entry.partners and entry.ended == entry.partners:
            have = "would have" if supposed else "has" if len(entry.ended) == 1 else "have"
            partners += f", which {have} ended"
        yield f"{_explained(entry)}, for {partners}" if partners else _explained(entry)
    if len(others) > MOST_OTHERS:
        yield f"and {len(others) - MOST_OTHERS} more"


def listed(names: Iterable[str]) -> str:
    """Names of processes, one after the other."""
    return ", ".join(f"`{name}`" for name in names)


def _explained(entry: BlockedProcess) -> str:
    place = "" if entry.span is None else f" ({entry.span})"
    return f"`{entry.name}` {entry.words}{place}"


def headline(found: Counterexample) -> str:
    """The failure in words that follow the name of the process."""
    steps = sum(step.shown for step in found.steps)
    when = "at once" if steps == 0 else f"after {steps} step{'s' if steps > 1 else ''}"
    stuck = len(found.ring) or len(found.waiting)
    match found.failure:
        case "deadlock" | "knot":
            is_knot = found.failure == "knot"
            ever = " forever" * is_knot
            who = "a process waits" if stuck == 1 else f"{stuck} processes wait"
            each = "itself" if stuck == 1 else "each other"
            wait = f" for {each}{ever}" if found.ring else f"{ever} for something that never happens"
            others = ", while others continue" * is_knot
            return f"can {'get stuck' if is_knot else 'deadlock'}: {when}, {who}{wait}{others}"
        case "livelock":
            return f"can livelock: {when}, it can run forever without a communication that its environment sees"
        case "no termination":
            if found.cycle:
                return f"does not always end: {when}, it can repeat the following steps forever"
            return (
                f"does not always end: {when}, {'a process waits' if stuck == 1 else f'{stuck} processes wait'} for "
                "something that never happens"
            )
        case "refinement":
            return f"does not refine its specification: {found.reason or when}"
