"""Values on their way to a file."""

from __future__ import annotations

from itertools import pairwise
from random import Random

import numpy
import pytest

from cspdiag.simulate.record.streamed import blocks as module
from cspdiag.simulate.record.streamed.blocks import Block, halved, in_pieces


@pytest.mark.parametrize("start", range(20))
def test_pieces_are_cut_at_common_instants_and_are_all_of_it(start: int, monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = Random(start)
    monkeypatch.setattr(module, "MOST_AT_ONCE", chosen.randint(1, 12))
    blocks = []
    for port in range(chosen.randint(1, 4)):
        time = numpy.array(sorted(chosen.choices(range(30), k=chosen.randint(1, 40))), dtype=numpy.int64)
        blocks.append(Block(port, time, numpy.arange(len(time))))
    pieces = list(in_pieces(blocks))
    for block in blocks:
        own = [part for piece in pieces for part in piece if part.port == block.port]
        assert numpy.concatenate([part.time for part in own]).tolist() == block.time.tolist()
        assert numpy.concatenate([part.value for part in own]).tolist() == block.value.tolist()
    spans = [(min(part.time[0] for part in piece), max(part.time[-1] for part in piece)) for piece in pieces]
    assert all(before[1] < after[0] for before, after in pairwise(spans))


def test_halves_are_cut_at_a_common_instant() -> None:
    fast = Block(0, numpy.array([0, 1, 1, 2, 3]), numpy.array([10, 11, 12, 13, 14]))
    slow = Block(1, numpy.array([0]), numpy.array([20]))
    halves = halved([fast, slow])
    assert halves is not None
    assert [[(part.port, part.time.tolist(), part.value.tolist()) for part in half] for half in halves] == [
        [(0, [0, 1, 1], [10, 11, 12]), (1, [0], [20])],
        [(0, [2, 3], [13, 14])],
    ]
    assert halved([Block(0, numpy.array([1, 1]), numpy.array([5, 6]))]) is None
