"""The figures of a recording: what an assistant wants to know of a run without reading all of it."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import TypedDict


class Figures(TypedDict, total=False):
    """A column of a recording. Numbers have the least, greatest and last; other values the last, and how often the
    value changed.
    """

    least: float
    greatest: float
    last: float | str
    changes: int


def figures_of(recording: Path) -> dict[str, Figures]:
    """The figures of each column of a recording as CSV."""
    found: dict[str, Figures] = {}
    for row in _rows(recording):
        for name, text in row.items():
            if name == "time" or not text:
                continue
            figures = found.setdefault(name, Figures(changes=0))
            before = figures.get("last")
            value = _value(text)
            if isinstance(value, float):
                figures["least"] = min(value, figures.get("least", value))
                figures["greatest"] = max(value, figures.get("greatest", value))
            if before is not None and before != value:
                figures["changes"] += 1
            figures["last"] = value
    return found


def _rows(recording: Path) -> Iterator[dict[str, str]]:
    with recording.open(newline="", encoding="utf-8") as file:
        yield from csv.DictReader(file)


def _value(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text
