"""The summary that is printed after a run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, assert_never

from cspdiag.runtime.kernel.durations import shown
from cspdiag.runtime.kernel.signals import name_of_signal
from cspdiag.simulate.record.modes import mode_groups

if TYPE_CHECKING:
    from cspdiag.runtime import Outcome
    from cspdiag.simulate.record.run_data import RunData


def summary(run: RunData) -> str:
    """Several lines: why and when the run ended, which processes ended when, missed samples, jitter."""
    return "\n".join(_lines(run))


def _lines(run: RunData) -> Iterator[str]:
    outcome = run.outcome
    where = f" in {run.environment.name}" if run.environment is not None else ""
    yield f"{run.network.top}{where}: {_ending(run)}"
    chosen = f", {run.chosen_target}" if run.chosen_target else ""
    yield f"  {_effort(outcome)}{chosen}"
    yield from _process_lines(run)
    missed = {port: count for port, count in outcome.missed.items() if count}
    yield "  missed samples: " + (", ".join(f"{port} {count}" for port, count in missed.items()) or "none")
    if outcome.preference:
        yield f"  {outcome.preference}"
    for period, jitter in outcome.jitter.items():
        if jitter.count:
            yield f"  jitter of the {shown(period)} period: {jitter}"
    for link in outcome.links:
        yield f"  {link}"
    from cspdiag.runtime.kernel.exceptions import described

    for error in outcome.release_errors:
        yield f"  while releasing outputs: {described(error)}"


def _effort(outcome: Outcome) -> str:
    if outcome.real_time:
        return f"ran {shown(outcome.time)} against the clock, {outcome.wall_time:.3g} s with start and end"
    simulated = f"simulated {shown(outcome.time)} in {outcome.wall_time:.3g} s"
    if outcome.time == 0 or outcome.wall_time == 0:
        return simulated
    return f"{simulated}, {_three_digits(outcome.time / 1e9 / outcome.wall_time)} times real time"


def _three_digits(factor: float) -> str:
    """A factor with three digits: ``45.8``, ``6610``, never ``6.61e+03``."""
    return f"{factor:.3g}" if factor < 1000 else f"{float(f'{factor:.3g}'):.0f}"


def _ending(run: RunData) -> str:
    outcome = run.outcome
    at = f"at {shown(outcome.time)}"
    match outcome.ended:
        case "terminated":
            return f"ended by itself {at}"
        case "time limit":
            return f"reached the time limit {at}"
        case "stopped":
            from cspdiag.runtime.kernel.exceptions import described

            hanging = f": {described(outcome.error)}" if outcome.error is not None else ""
            return f"stopped by {name_of_signal(outcome.signal)} {at}{hanging}"
        case "deadlock":
            return f"deadlock {at}"
        case "failed":
            assert outcome.error is not None
            from cspdiag.runtime.kernel.exceptions import described

            return f"ended unsuccessfully {at}: {described(outcome.error)}"
        case _:
            assert_never(outcome.ended)


_SHOWN = 8
"""If a group has more processes than this, they are counted instead of listed."""
_MOST_GROUPS = 24
"""If there are more groups than this, all their processes are counted."""


def _process_lines(run: RunData) -> Iterator[str]:
    ends = {activity.path: activity.end for activity in run.activities}
    groups = mode_groups(run.network)
    if len(groups) > _MOST_GROUPS:
        begun = [ends[path] for group in groups for path in group.modes if path in ends]
        yield f"  {sum(end is not None for end in begun)} of {len(begun)} processes ended"
        return
    for group in groups:
        run_ = [(name, ends[path]) for path, name in group.modes.items() if path in ends]
        if 0 < len(run_) <= _SHOWN:
            words = (f"{name} running" if end is None else f"{name} until {shown(end)}" for name, end in run_)
            yield f"  {group.name}: {', '.join(words)}"
        elif run_:
            ended = [end for _, end in run_ if end is not None]
            last = f", the last at {shown(max(ended))}" if ended else ""
            yield f"  {group.name}: {len(ended)} of {len(run_)} processes ended{last}"
