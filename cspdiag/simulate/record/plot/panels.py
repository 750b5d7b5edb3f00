"""Which curves share a panel (those of one unit and of similar size, and those of one port), and which coincide."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from cspdiag.base.record import record
from cspdiag.simulate.record.plot.series import Series, quantity

if TYPE_CHECKING:
    import numpy

_MOST_CURVES = 6
"""The number of curves in one panel; further curves have another panel."""
_LIKE = 100
"""The smallest of the curves of a panel is visible if the largest is at most this many times as large."""
_ON_EACH_OTHER = 0.02
"""Part of a panel's height within which two curves look like one."""
_LOOKED_AT = 200
"""Instants at which curves are compared."""


@record
class Row:
    """A panel: the text of its axis, the class of the size of its values, and its number among the panels of both."""

    unit: str
    size: int
    number: int


class Sizes:
    """Classes of size of the values of a unit: in one class the greatest is at most 100 times the least."""

    def __init__(self, values: Iterable[tuple[str, float]]) -> None:
        self._classes: dict[str, list[tuple[float, float]]] = {}
        self.add(values)

    def add(self, values: Iterable[tuple[str, float]]) -> None:
        """Add the greatest values of curves with their units; those that already have a class keep it."""
        for unit, size in sorted(values):
            classes = self._classes.setdefault(unit, [])
            number = self.of(unit, size)
            if number == len(classes) and size:
                classes.append((size, size))
            elif size:
                least, most = classes[number]
                classes[number] = min(least, size), max(most, size)

    def of(self, unit: str, size: float) -> int:
        """The number of the class; curves of zeros only are in the first."""
        classes = self._classes.get(unit, [])
        fits = (at for at, (least, most) in enumerate(classes) if max(most, size) <= _LIKE * min(least, size))
        return next(fits, len(classes)) if size else 0


def greatest(series: Series, end: float) -> float:
    """The greatest absolute value during the run; the safe values at its end do not count."""
    import numpy

    values = numpy.abs(series.value[(series.time < end) | (not series.is_output)].astype(float))
    values = values[numpy.isfinite(values)]
    return float(values.max()) if len(values) else 0.0


def panels_of(curves: Sequence[Series], size: Callable[[Series], int]) -> dict[Row, list[Series]]:
    """The curves by panel. The elements of a port share panels; if they need several, no other port does."""
    panels: dict[Row, list[Series]] = {}
    ports: dict[tuple[str, int, str], list[Series]] = {}
    for series in curves:
        ports.setdefault((quantity(series.type), size(series), _array(series)), []).append(series)
    for (unit, kind, _), of_port in ports.items():
        used = [row for row in panels if (row.unit, row.size) == (unit, kind)]
        last = panels[used[-1]] if used else []
        if used and len(last) + len(of_port) <= _MOST_CURVES and not _is_rest(used, panels):
            last += of_port
            continue
        parts = -(-len(of_port) // _MOST_CURVES)
        each = -(-len(of_port) // parts)
        for part in range(parts):
            panels[Row(unit, kind, len(used) + part)] = of_port[part * each : (part + 1) * each]
    return panels


def _is_rest(used: Sequence[Row], panels: dict[Row, list[Series]]) -> bool:
    """Whether the last panel has the last elements of a port that fills several panels."""
    return len(used) > 1 and _array(panels[used[-2]][-1]) == _array(panels[used[-1]][-1])


def _array(series: Series) -> str:
    """The name of its port as declared: the elements of an array of ports are ports of their own."""
    return series.port.partition("[")[0]


def coinciding_later(curves: Sequence[Series], end: float) -> list[int]:
    """For each curve the number of later ones in the panel that look the same: it has to be wider to be visible below
    them.
    """
    import numpy

    instants = numpy.linspace(0, end, _LOOKED_AT, endpoint=False)
    held = [_held(series, instants) for series in curves]
    known = [values[numpy.isfinite(values)] for values in held]
    everything = numpy.concatenate(known) if known else numpy.array([])
    height = float(numpy.ptp(everything)) if len(everything) else 0.0
    return [
        sum(_alike(one, other, _ON_EACH_OTHER * height) for other in held[position + 1 :])
        for position, one in enumerate(held)
    ]


def _held(series: Series, instants: numpy.ndarray) -> numpy.ndarray:
    import numpy

    if not len(series.time):
        return numpy.full(_LOOKED_AT, numpy.nan)
    position = numpy.searchsorted(series.time, instants, side="right") - 1
    return numpy.where(position >= 0, series.value.astype(float)[numpy.maximum(position, 0)], numpy.nan)


def _alike(one: numpy.ndarray, other: numpy.ndarray, within: float) -> bool:
    import numpy

    differences = numpy.abs(one - other)
    differences = differences[numpy.isfinite(differences)]
    return len(differences) > _LOOKED_AT // 10 and float(numpy.median(differences)) <= within
