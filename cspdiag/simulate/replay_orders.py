"""Other orders of the steps of a trace: steps without a common party may be exchanged."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.simulate.replay_trace import TraceStep


def sooner(steps: Sequence[TraceStep], position: int) -> tuple[TraceStep, ...]:
    """The same steps; the one at ``position``, with those on which it depends, as early as it can come."""
    needed = {position}
    parties = {name for name, _ in steps[position].parties}
    for earlier in range(position - 1, -1, -1):
        own = {name for name, _ in steps[earlier].parties}
        if own & parties:
            needed.add(earlier)
            parties |= own
    before = [step for number, step in enumerate(steps[:position]) if number in needed]
    after = [step for number, step in enumerate(steps) if number not in needed]
    return (*before, steps[position], *after)


def later(steps: Sequence[TraceStep], position: int) -> tuple[TraceStep, ...]:
    """The same steps; the one at ``position``, with those that depend on it, as late as it can come."""
    put_off = {position}
    parties = {name for name, _ in steps[position].parties}
    for following in range(position + 1, len(steps)):
        own = {name for name, _ in steps[following].parties}
        if own & parties:
            put_off.add(following)
            parties |= own
    first = [step for number, step in enumerate(steps) if number not in put_off]
    return (*first, *(steps[number] for number in sorted(put_off)))
