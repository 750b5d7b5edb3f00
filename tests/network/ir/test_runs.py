"""Rows that repeat but for numbers that count, and what follows from two lists of them."""

from __future__ import annotations

import pytest

from cspdiag.network.elaborate.fewer.extrapolation import Extrapolation, IrregularError
from cspdiag.network.elaborate.fewer.rows import examples, repetitions, rows_from, strands
from cspdiag.network.elaborate.fewer.runs import runs
from cspdiag.network.ir.actions import ChannelEnd
from cspdiag.network.ir.network import Connection

FROM = Extrapolation(24, 48, 300)


def attached(port: str, channel: str, index: int | None = None) -> Connection:
    return Connection(port=port, index=index, attachment=ChannelEnd(channel))


def ring(size: int) -> tuple[object, ...]:
    cells = [
        (attached("input", f"cell[{(i - 1) % size}].x{{}}"), attached("output", f"cell[{i}].x{{}}"))
        for i in range(size)
    ]
    pairs = [attached(port, f"{port}[{i}]", i) for i in range(2, size) for port in ("first", "second")]
    return ("ring", size, *cells, "between", *pairs, (2 * size, True, None, 1.5), ("end",) * 3)


def test_rows_that_repeat_are_runs() -> None:
    found = [(run.rounds, run.steps) for run in runs(ring(24)) if run.rounds > 1]
    assert found == [(23, ((1, 0, 1, 0),)), (22, ((1, 1, 0), (1, 1, 0)))]
    assert sum(len(run.rows) * run.rounds for run in runs(ring(24))) == len(ring(24))


def test_more_rows_follow_from_few() -> None:
    assert FROM.of(ring(24), ring(48)) == ring(300)


def test_of_rows_that_follow_it_is_known_where_they_repeat() -> None:
    rows = FROM.of(ring(24), ring(48))
    assert [(found.start, found.length, found.rounds) for found in repetitions(rows) if found.rounds > 1] == [
        (3, 1, 299),
        (303, 2, 298),
    ]
    assert [row for found in repetitions(rows) for row in found.of(rows)] == list(rows)
    assert sorted(position for strand in strands(rows) for position in strand.of(range(len(rows)))) == [
        *range(len(rows))
    ]
    assert len(examples(rows)) < 14
    assert rows_from(rows, 3) == 299
    assert rows_from(rows, 100) == 202
    assert rows_from(rows, 303) == 1


def test_of_other_rows_nothing_is_known() -> None:
    rows = ring(24)
    assert [found.of(rows) for found in repetitions(rows)] == [rows]
    assert [strand.of(rows) for strand in strands(rows)] == [(row,) for row in rows]
    assert examples(rows) is rows
    assert rows_from(rows, 3) == 1


def test_only_the_ends_of_runs_are_wanted() -> None:
    ends = Extrapolation(24, 48, 300, only_ends=True).of(ring(24), ring(48))
    whole = ring(300)
    assert ends[:6] == (*whole[:4], whole[301], "between")
    assert ends[6:10] == (*whole[303:305], *whole[-4:-2])


@pytest.mark.parametrize(
    ("few", "some"),
    [
        ((1,), (2,)),  # grows by less than the size
        ((-275,), (-251,)),  # becomes 1
        (("a[1]",), ("b[25]",)),
        ((1.0,), (2.0,)),
        ((1,), (True,)),
        (tuple(range(24)), tuple(range(0, 96, 2))),
        (tuple(range(-200, -176)), tuple(range(-200, -152))),  # passes through 0 later
        (tuple(range(24)), tuple(range(47))),
        ((*range(24), "a"), (*range(48), "b")),
        ((*range(24), "a"), tuple(range(48))),
    ],
)
def test_nothing_follows_from_what_does_not_continue(few: tuple[object, ...], some: tuple[object, ...]) -> None:
    with pytest.raises(IrregularError):
        FROM.of(few, some)
