"""Times between the steps of a sequence, as prefix sums, so a long sequence takes only linear time."""

from __future__ import annotations

from bisect import bisect_left

from cspdiag.base import Span
from cspdiag.base.record import record, replaced
from cspdiag.network.shapes import Key

_LARGEST_SEARCH = 64
"""Among this number of steps the longest delay is searched, to be marked."""


@record
class Gap:
    """The time that certainly passes between two reads: nanoseconds of waiting, and an event that is waited for;
    ``cause`` is the place of the longest wait.

    ``credit`` is the part of it that is covered by samples which are read meanwhile, one period each. It is negative
    after a ``competing_event``, which an alternative waits for together with the samples and which may occur when the
    next sample is due. If not ``on_every_path``, some path takes less than ``duration``, or may do so.
    """

    duration: int = 0
    event: Key | None = None
    cause: Span | None = None
    credit: int = 0
    competing_event: Key | None = None
    on_every_path: bool = True

    def then(self, later: Gap) -> Gap:
        """One gap after the other."""
        if later is NOTHING:
            return self
        is_first = self.event is not None or (self.duration >= later.duration and later.event is None)
        cause = (self.cause or later.cause) if is_first else (later.cause or self.cause)
        return Gap(
            self.duration + later.duration,
            self.event or later.event,
            cause,
            self.credit + later.credit,
            self.competing_event or later.competing_event,
            self.on_every_path and later.on_every_path,
        )

    @property
    def maybe_shorter(self) -> Gap:
        """The same gap, which something may end earlier."""
        takes_time = bool(self.duration) or self.event is not None
        return replaced(self, on_every_path=False) if takes_time and self.on_every_path else self

    @property
    def late(self) -> int:
        """How long ago the last sample arrived that was read, if it was read on arrival."""
        return self.duration - self.credit

    @property
    def rank(self) -> tuple[bool, int]:
        """A key that orders gaps by length; waiting for an event is longer than any known time."""
        return self.event is not None, self.late


NOTHING = Gap()


def then(first: Gap | None, second: Gap | None) -> Gap | None:
    """One gap after the other; None if one of them has no path."""
    return None if first is None or second is None else first.then(second)


def either(one: Gap | None, other: Gap | None) -> Gap | None:
    """The longer of two paths, None for one that does not exist."""
    if one is None or other is None:
        return other if one is None else one
    longer, shorter = (one, other) if one.rank >= other.rank else (other, one)
    is_as_long = shorter.on_every_path and (
        shorter.duration >= longer.duration if longer.event is None else shorter.event is not None
    )
    return longer if is_as_long else longer.maybe_shorter


def both(one: Gap | None, other: Gap | None) -> Gap | None:
    """Two gaps at the same time, of which the longer one counts."""
    if one is None or other is None:
        return other if one is None else one
    return one if one.rank >= other.rank else other


class Elapsed:
    """The time that the steps of a sequence have taken so far; a position is a moment between two steps."""

    def __init__(self) -> None:
        self._steps: list[Gap] = []
        self._sums = [0]
        self._events: list[int] = []
        self._choices: list[int] = []
        """The positions of the steps that may take less."""
        self._end = -1
        """The position of the last step without a path through it."""

    @property
    def position(self) -> int:
        """The present moment."""
        return len(self._steps)

    def add(self, time: Gap | None) -> None:
        """Add a step; None if no path leads through it."""
        if time is NOTHING:
            return
        if time is None:
            self._end = self.position
        else:
            if time.event is not None:
                self._events.append(self.position)
            if not time.on_every_path:
                self._choices.append(self.position)
        self._steps.append(time or NOTHING)
        self._sums.append(self._sums[-1] + (time.duration if time is not None else 0))

    def since(self, position: int) -> Gap | None:
        """The gap from a moment until now; None if no path leads from there to here."""
        if self._end >= position:
            return None
        if position == self.position:
            return NOTHING
        index = bisect_left(self._events, position)
        event = self._steps[self._events[index]] if index < len(self._events) else None
        longest = event or max(self._steps[position : position + _LARGEST_SEARCH], key=lambda step: step.duration)
        return Gap(
            self._sums[-1] - self._sums[position],
            None if event is None else event.event,
            longest.cause,
            on_every_path=not self._choices or self._choices[-1] < position,
        )
