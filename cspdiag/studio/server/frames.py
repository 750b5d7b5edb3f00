"""Frames of a running program that wait for a slow viewer: several become one, and long ones are thinned."""

from __future__ import annotations

from typing import Any, TypeAlias

Frame: TypeAlias = "dict[str, Any]"
"""The parameters of the notification ``frame``."""

MOST_VALUES = 2_000
"""How many values of one signal a merged frame keeps: more than a plot has columns."""
MOST_VALUES_OF_ALL = 40_000
"""How many values of all signals together."""

MOST_COMMUNICATIONS = 200


def merged(earlier: Frame, later: Frame) -> Frame:
    """One frame for two of the same session that follow each other.

    States, such as who waits, are those of the later one. ``omitted`` counts communications that are left out, and
    ``thinned`` says that values are.
    """
    frame = {**earlier, **later, "from": earlier["from"]}
    thinned = bool(earlier.get("thinned") or later.get("thinned"))
    signals = {name: _joined(earlier, later, name) for name in {**earlier["signals"], **later["signals"]}}
    counts = [len(series["t"]) for series in signals.values()]
    most = MOST_VALUES if sum(counts) <= MOST_VALUES_OF_ALL else max(2, MOST_VALUES_OF_ALL // len(counts))
    if any(count > most for count in counts):
        signals = {name: _thinned(series, most) for name, series in signals.items()}
        thinned = True
    frame["signals"] = signals
    for key in ("modes", "started", "ended"):
        frame[key] = [*earlier.get(key, ()), *later.get(key, ())]
    communications = [*earlier.get("communications", ()), *later.get("communications", ())]
    left_out = max(0, len(communications) - MOST_COMMUNICATIONS)
    frame["communications"] = communications[left_out:]
    frame["omitted"] = earlier.get("omitted", 0) + later.get("omitted", 0) + left_out
    if thinned:
        frame["thinned"] = True
    return frame


def _joined(earlier: Frame, later: Frame, name: str) -> dict[str, list[Any]]:
    both = [frame["signals"][name] for frame in (earlier, later) if name in frame["signals"]]
    return {key: [value for series in both for value in series[key]] for key in ("t", "v")}


def _thinned(series: dict[str, list[Any]], most: int) -> dict[str, list[Any]]:
    """Every second value, and the last one, if there are more than ``most``."""
    if len(series["t"]) <= most:
        return series
    return {key: [*values[:-1:2], values[-1]] for key, values in series.items()}
