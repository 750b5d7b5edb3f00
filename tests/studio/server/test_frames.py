"""Frames that wait for a slow page are merged, and stay small."""

from __future__ import annotations

from typing import Any

from cspdiag.studio.server.frames import MOST_COMMUNICATIONS, MOST_VALUES, merged


def _frame(begin: int, end: int, **more: Any) -> dict[str, Any]:
    times = list(range(begin, end))
    return {"session": "1", "from": begin, "to": end - 1, "signals": {"a": {"t": times, "v": times}}, **more}


def test_a_merged_frame_has_the_values_of_both_and_the_state_of_the_later() -> None:
    earlier = _frame(0, 3, waiting=["P"], modes=[1], communications=[{"t": 1}])
    later = _frame(3, 5, waiting=["Q"], modes=[2], communications=[{"t": 3}], omitted=4)
    later["signals"]["b"] = {"t": [4], "v": [True]}
    frame = merged(earlier, later)
    assert (frame["from"], frame["to"]) == (0, 4)
    assert frame["signals"] == {"a": {"t": [0, 1, 2, 3, 4], "v": [0, 1, 2, 3, 4]}, "b": {"t": [4], "v": [True]}}
    assert frame["waiting"] == ["Q"]
    assert frame["modes"] == [1, 2]
    assert frame["communications"] == [{"t": 1}, {"t": 3}]
    assert frame["omitted"] == 4
    assert "thinned" not in frame


def test_a_merged_frame_stays_small_however_many_it_was() -> None:
    frame = _frame(0, 17, communications=[])
    for begin in range(17, 170_000, 17):
        frame = merged(frame, _frame(begin, begin + 17, communications=[{"t": begin}]))
    series = frame["signals"]["a"]
    assert len(series["t"]) <= MOST_VALUES
    assert series["t"] == series["v"] == sorted(series["t"])
    assert series["t"][-1] == frame["to"]
    assert frame["thinned"]
    assert len(frame["communications"]) == MOST_COMMUNICATIONS
    assert frame["omitted"] == 9_999 - MOST_COMMUNICATIONS
