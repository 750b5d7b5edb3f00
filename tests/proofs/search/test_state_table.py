"""The table of states keeps each state once, whatever the batches contain, and grows."""

from __future__ import annotations

from itertools import pairwise
from random import Random

import numpy as np
import pytest

from cspdiag.proofs.search import state_table
from cspdiag.proofs.search.packing import Words
from cspdiag.proofs.search.state_table import StateTable
from cspdiag.proofs.verdict import LimitError, Limits


def batch(states: list[tuple[int, ...]], words: int) -> Words:
    return [np.array([state[word] for state in states], np.int64) for word in range(words)]


@pytest.mark.parametrize("words", [1, 2, 3])
def test_each_state_has_one_number_and_numbers_follow_the_batches(words: int) -> None:
    random = Random(words)
    table = StateTable(words, Limits())
    known: dict[tuple[int, ...], int] = {}
    counts = [0]
    for _ in range(12):
        states = [tuple(random.randrange(4) << random.randrange(61) for _ in range(words)) for _ in range(3000)]
        table.add(batch(states, words))
        fresh = [state for state in dict.fromkeys(states) if state not in known]
        assert table.count == len(known) + len(fresh)
        numbers = table.find(batch(states, words)).tolist()
        for state, number in zip(states, numbers, strict=True):
            assert known.setdefault(state, number) == number
        counts.append(table.count)
        assert {known[state] for state in fresh} == set(range(*list(pairwise(counts))[-1]))
    stored = table.states(0, table.count)
    assert [tuple(int(word[number]) for word in stored) for number in known.values()] == list(known)
    absent = [tuple([(1 << 61) + 12345] * words)]
    assert table.find(batch(absent, words)).tolist() == [-1]


def test_states_of_several_words_with_equal_keys_are_distinguished(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(state_table, "_keys", lambda words: (words[0] & 1) + 1)
    table = StateTable(2, Limits())
    states = [(one, other) for one in range(20) for other in range(20)]
    table.add(batch(states + states, 2))
    assert table.count == 400
    assert sorted(table.find(batch(states, 2)).tolist()) == list(range(400))


def test_more_memory_than_allowed_is_not_taken() -> None:
    table = StateTable(1, Limits(memory=1_000_000))
    with pytest.raises(LimitError, match="memory limit of 1 MB"):
        table.add([np.arange(100_000, dtype=np.int64)])
    assert table.bytes <= 1_000_000
