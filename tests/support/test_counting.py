"""What is counted is the work alone."""

from __future__ import annotations

import gc
import weakref

from tests.support.counting import calls, lines


class Left:
    """Something in a circle, which only the collector of garbage finds."""

    def __init__(self) -> None:
        self.itself = self
        self.finalized = weakref.finalize(self, len, ())


def work() -> list[list[int]]:
    return [[] for _ in range(5_000)]


def test_garbage_of_others_is_not_counted() -> None:
    counts = []
    seldom = gc.get_threshold()
    gc.set_threshold(1_000)
    try:
        for garbage in (0, 100):  # few, so that none is collected while it is made
            for count in (calls, lines):
                gc.collect()
                left = [Left() for _ in range(garbage)]
                left.clear()
                counts.append(count(work))
    finally:
        gc.set_threshold(*seldom)
    assert counts[:2] == counts[2:]
