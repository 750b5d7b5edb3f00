"""Who waits for whom, in sentences."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from cspdiag.analyses.counterexamples.counterexample import Counterexample, Waiting

MOST_OTHERS = 8


def waiting_lines(found: Counterexample) -> Iterator[str]:
    """A line for each process that never goes on, those that wait for each other first."""
    by_name = {entry.name: entry for entry in found.waiting}
    following = (*found.ring[1:], *found.ring[:1])
    for name, partner in zip(found.ring, following, strict=True):
        yield f"{_told(by_name[name])}, for `{partner}`"
    others = [entry for entry in found.waiting if entry.name not in found.ring]
    for entry in others[:MOST_OTHERS]:
        partners = listed(entry.partners[:MOST_OTHERS])
        if entry.partners and entry.ended == entry.partners:
            partners += f", which {'has' if len(entry.ended) == 1 else 'have'} ended"
        yield f"{_told(entry)}, for {partners}" if partners else _told(entry)
    if len(others) > MOST_OTHERS:
        yield f"and {len(others) - MOST_OTHERS} more"


def listed(names: Iterable[str]) -> str:
    """Names of processes, one after the other."""
    return ", ".join(f"`{name}`" for name in names)


def _told(entry: Waiting) -> str:
    place = "" if entry.span is None else f" ({entry.span})"
    return f"`{entry.name}` {entry.words}{place}"


def headline(found: Counterexample) -> str:
    """What is wrong, in a sentence that goes on from the name of the process."""
    steps = sum(step.shown for step in found.steps)
    when = "at once" if steps == 0 else f"after {steps} step{'s' if steps > 1 else ''}"
    stuck = len(found.ring) or len(found.waiting)
    match found.failure:
        case "deadlock" | "knot":
            is_knot = found.failure == "knot"
            ever = " for ever" * is_knot
            who = "a process waits" if stuck == 1 else f"{stuck} processes wait"
            each = "itself" if stuck == 1 else "each other"
            wait = f" for {each}{ever}" if found.ring else f"{ever} for what never comes"
            others = ", while others go on" * is_knot
            return f"can {'get stuck' if is_knot else 'deadlock'}: {when}, {who}{wait}{others}"
        case "livelock":
            return f"can livelock: {when}, it can go on for ever without a communication that anybody sees"
        case "no termination":
            if found.cycle:
                return f"does not always end: {when}, it can repeat for ever what follows"
            return f"does not always end: {when}, {'a process waits' if stuck == 1 else f'{stuck} processes wait'} for what never comes"
        case "refinement":
            return f"does not refine its specification: {found.reason or when}"
