"""Whether a run has the values of a trace; what the proof left open may have any value."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from cspdiag.model.types import RealType, Type
from cspdiag.network.dump.expression import value_text
from cspdiag.verify.runs.trace import Trace
from cspdiag.verify.runs.values import HANDED_ON, is_written_as

PASSING = frozenset({"communication", "external", "sample"})
"""The kinds of steps in which a value passes."""


class _Valued(Protocol):
    """A step of a trace or of a counterexample."""

    @property
    def kind(self) -> str: ...
    @property
    def channel(self) -> str: ...
    @property
    def value(self) -> str | None: ...


def agrees(value: Any, type_: Type, expected: str | None) -> bool:
    """Whether a value of a run agrees with that of a trace: the value itself, a range with it, or None."""
    if expected is None or expected in HANDED_ON:
        return True
    try:
        return is_written_as(value, type_, expected) or (isinstance(type_, RealType) and float(expected) == value)
    except ValueError:
        return False


def differing(steps: Sequence[_Valued], made: Sequence[tuple[str, Any]], types: Mapping[str, Type]) -> dict[int, Any]:
    """For each channel on which a run had other values, the number of the first such step, and the value that it had;
    None if it had fewer.

    ``made`` are its communications, (channel, value) in order. Where a run passes a channel more or less often than the
    steps, as with further rounds of a loop, theirs are in order among its own.
    """
    numbers: defaultdict[str, list[int]] = defaultdict(list)
    for number, step in enumerate(steps):
        if step.kind in PASSING and step.channel in types:
            numbers[step.channel].append(number)
    values: defaultdict[str, list[Any]] = defaultdict(list)
    for channel, value in made:
        values[channel].append(value)
    found = {}
    for channel, of_channel in numbers.items():
        expected = [steps[number].value for number in of_channel]
        unlike = _first_unlike(expected, values[channel], types[channel])
        if unlike is not None:
            position, value = unlike
            found[of_channel[position]] = value
    return dict(sorted(found.items()))


def _first_unlike(given: Sequence[str | None], had: Sequence[Any], type_: Type) -> tuple[int, Any] | None:
    """Where the values of one channel first differ from those given, and the value there instead."""
    position = 0
    for number, text in enumerate(given):
        if len(given) == len(had):
            if not agrees(had[number], type_, text):
                return number, had[number]
            continue
        expected = position
        while position < len(had) and not agrees(had[position], type_, text):
            position += 1
        if position >= len(had) and text is not None:
            return number, had[expected] if expected < len(had) else None
        position += 1
    return None


def difference(trace: Trace, made: Sequence[tuple[str, Any]], types: Mapping[str, Type]) -> tuple[int, str] | None:
    """The first step of a trace with another value than a run had: its number and a sentence; None if there is no such
    step.
    """
    steps = (*trace.steps, *trace.cycle)
    for number, value in differing(steps, made, types).items():
        step = steps[number]
        had = "not that value" if value is None else f"`{value_text(value, types[step.channel])}`"
        return (
            number,
            f"the trace has `{step.value}` at `{step.channel}` in step {trace.shown_before(number) + 1}, and the "
            f"program {had}",
        )
    return None
