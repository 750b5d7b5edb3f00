"""Times between the steps of a sequence, added up so that a long one costs no more than its length."""

from __future__ import annotations

from bisect import bisect_left

from cspdiag.base import Span
from cspdiag.base.record import record, replaced
from cspdiag.network.shapes import Key

_LOOKED_AT = 64
"""Steps among which the longest delay is looked for, to be marked."""


@record
class Gap:
    """What certainly lies between two reads: nanoseconds of waiting, and an event that is waited for, with the place of
    what takes most.

    ``credit`` is how much of it the samples take that are read meanwhile, one period each; it is negative after an
    event ``beside`` the samples, which may come when the next one is due. Where not ``on_every_way``, there is a path
    that takes less than ``duration``, or may be.
    """

    duration: int = 0
    event: Key | None = None
    cause: Span | None = None
    credit: int = 0
    beside: Key | None = None
    on_every_way: bool = True

    def then(self, later: Gap) -> Gap:
        """One after the other."""
        if later is NOTHING:
            return self
        is_first = self.event is not None or (self.duration >= later.duration and later.event is None)
        cause = (self.cause or later.cause) if is_first else (later.cause or self.cause)
        return Gap(
            self.duration + later.duration,
            self.event or later.event,
            cause,
            self.credit + later.credit,
            self.beside or later.beside,
            self.on_every_way and later.on_every_way,
        )

    @property
    def perhaps(self) -> Gap:
        """The same, where something may end it before."""
        takes_time = bool(self.duration) or self.event is not None
        return replaced(self, on_every_way=False) if takes_time and self.on_every_way else self

    @property
    def late(self) -> int:
        """How long ago the last sample came that was read, if it was read as it came."""
        return self.duration - self.credit

    @property
    def rank(self) -> tuple[bool, int]:
        """Waiting for an event takes longer than any time."""
        return self.event is not None, self.late


NOTHING = Gap()


def then(first: Gap | None, second: Gap | None) -> Gap | None:
    """One after the other; None if there is no path through one of them."""
    return None if first is None or second is None else first.then(second)


def either(one: Gap | None, other: Gap | None) -> Gap | None:
    """The longer of two paths, None for one that does not exist."""
    if one is None or other is None:
        return other if one is None else one
    longer, shorter = (one, other) if one.rank >= other.rank else (other, one)
    is_as_long = shorter.on_every_way and (
        shorter.duration >= longer.duration if longer.event is None else shorter.event is not None
    )
    return longer if is_as_long else longer.perhaps


def both(one: Gap | None, other: Gap | None) -> Gap | None:
    """Two at the same time, of which the longer counts."""
    if one is None or other is None:
        return other if one is None else one
    return one if one.rank >= other.rank else other


class Elapsed:
    """What the steps of a sequence have taken so far; a position is a moment between two of them."""

    def __init__(self) -> None:
        self._steps: list[Gap] = []
        self._sums = [0]
        self._events: list[int] = []
        self._choices: list[int] = []
        """The positions of the steps that may also take less."""
        self._end = -1
        """The position of the last step without a path through it."""

    @property
    def position(self) -> int:
        """The present moment."""
        return len(self._steps)

    def add(self, time: Gap | None) -> None:
        """Another step, None if there is no path through it."""
        if time is NOTHING:
            return
        if time is None:
            self._end = self.position
        else:
            if time.event is not None:
                self._events.append(self.position)
            if not time.on_every_way:
                self._choices.append(self.position)
        self._steps.append(time or NOTHING)
        self._sums.append(self._sums[-1] + (time.duration if time is not None else 0))

    def since(self, position: int) -> Gap | None:
        """From a moment until now; None if no path leads here from there."""
        if self._end >= position:
            return None
        if position == self.position:
            return NOTHING
        index = bisect_left(self._events, position)
        event = self._steps[self._events[index]] if index < len(self._events) else None
        longest = event or max(self._steps[position : position + _LOOKED_AT], key=lambda step: step.duration)
        return Gap(
            self._sums[-1] - self._sums[position],
            None if event is None else event.event,
            longest.cause,
            on_every_way=not self._choices or self._choices[-1] < position,
        )
