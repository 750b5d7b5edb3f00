"""Labels of events: values of one instant share one, and no label overlaps another or a mark."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.base.record import record

_TOGETHER = 1.5
"""The distance, in widths of a letter, below which marks look like one."""


@record
class Event:
    """A value as text, with the instant in seconds at which it arrived."""

    instant: float
    text: str


@record
class Label:
    """A text that begins at a place on the axis of time or, if ``is_left``, ends there."""

    place: float
    text: str
    is_left: bool


def labels_of(
    events: Sequence[Event], marks: Sequence[float], end: float, letter: float, gap: float
) -> Iterator[Label]:
    """A label for each group of events: its values; if they have no room, their number; or else a sign that there are
    some; or else nothing. All lie between 0 and ``end``. ``letter`` is the width of a letter on the axis of time,
    ``gap`` the distance from a mark to its label.
    """
    taken = [(mark, mark) for mark in marks]
    groups = [(group[0].instant - gap, group[-1].instant + gap, [*_texts(group)]) for group in _groups(events, letter)]
    for rank in range(max((len(texts) for *_, texts in groups), default=0)):
        rest = []
        for left, right, texts in groups:
            text = texts[min(rank, len(texts) - 1)]
            width = (len(text) + 1) * letter
            sides = [(right, right + width), (left - width, left)]
            room = next((side for side in sides if side[0] >= 0 and side[1] <= end and _is_free(side, taken)), None)
            if room is None:
                rest.append((left, right, texts))
                continue
            taken.append(room)
            is_left = room is sides[1]
            yield Label(left if is_left else right, text, is_left)
        groups = rest


def _is_free(side: tuple[float, float], taken: Sequence[tuple[float, float]]) -> bool:
    return not any(start < side[1] and side[0] < end for start, end in taken)


def _groups(events: Sequence[Event], letter: float) -> Iterator[Sequence[Event]]:
    """Events in order, grouped if they are too close to each other to have labels of their own."""
    start = 0
    for position in range(1, len(events) + 1):
        if position == len(events) or events[position].instant > events[start].instant + _TOGETHER * letter:
            yield events[start:position]
            start = position


def _texts(group: Sequence[Event]) -> Iterator[str]:
    yield ", ".join(event.text for event in group)
    if len(group) > 1:
        yield f"{len(group)} values"
    yield "…"
