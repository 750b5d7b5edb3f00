"""Labels of events: never two in one place, and never one that covers a mark."""

from __future__ import annotations

import random
from itertools import combinations

import pytest

from cspdiag.simulate.record.plot.labels import Event, Label, labels_of

END, LETTER = 100.0, 1.0


def label(*events: tuple[float, str], marks: tuple[float, ...] = (), gap: float = 0.0) -> list[tuple[str, float, bool]]:
    placed = labels_of([Event(*event) for event in events], marks, END, LETTER, gap)
    return [(each.text, each.place, each.is_left) for each in placed]


def test_values_of_one_instant_are_listed() -> None:
    assert label((5, "10"), (5, "20"), (5, "30")) == [("10, 20, 30", 5, False)]


def test_values_without_room_are_counted() -> None:
    values = [(5.0, "1000")] * 3
    assert label(*values, (20, "7"), marks=(5, 20)) == [("7", 20, False), ("3 values", 5, False)]


def test_a_label_without_room_for_the_count_shows_that_there_are_some() -> None:
    values = [(5.0, "1000")] * 3
    assert label(*values, (9, "7"), marks=(5, 9)) == [("7", 9, False), ("…", 5, False)]


def test_at_the_end_a_label_is_left_of_its_mark() -> None:
    assert label((END, "12345"), gap=1.0) == [("12345", END - 1.0, True)]


def test_a_label_that_has_no_room_at_all_is_left_out() -> None:
    assert label((5, "1"), (6.6, "2"), (8.2, "3"), marks=(5, 6.6, 8.2)) == [("1", 5, True), ("3", 8.2, False)]


@pytest.mark.parametrize("seed", range(200))
def test_no_label_touches_another_a_mark_or_the_ends_of_the_axis(seed: int) -> None:
    chance = random.Random(seed)
    instants = sorted(chance.choice([chance.uniform(0, END), 0, 50, END]) for _ in range(chance.randint(1, 25)))
    gap = chance.choice([0.0, LETTER])
    events = [Event(instant, str(chance.randint(0, 10 ** chance.randint(0, 9)))) for instant in instants]
    placed = [_interval(each) for each in labels_of(events, instants, END, LETTER, gap)]
    assert placed
    assert all(0 <= start < stop <= END for start, stop in placed)
    assert not [both for both in combinations(placed, 2) if both[0][0] < both[1][1] and both[1][0] < both[0][1]]
    assert not [mark for mark in instants for start, stop in placed if start < mark < stop]


def _interval(label: Label) -> tuple[float, float]:
    width = len(label.text) * LETTER
    return (label.place - width, label.place) if label.is_left else (label.place, label.place + width)
