"""What a plot shows of a run, as numbers: held values, unread samples, units, and no more points than can be seen."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from cspdiag.base.record import record, replaced
from cspdiag.model.types import BoolType, EnumType, RealType, TimeType, Type
from cspdiag.network.ir.network import ExternalPort
from cspdiag.simulate.record.leaves import leaves

if TYPE_CHECKING:
    import numpy

    from cspdiag.simulate.record.run_data import RunData

_COLUMNS = 1500
"""The number of columns that can be seen: of the values in one column only the first, the least, the greatest and the
last are drawn.
"""


@record
class Series:
    """The values of a port, or of an element of it, from each instant in seconds to the next; the last one to the end
    of the run.

    ``unread`` marks the values of a sampled input that were never read. ``is_event`` marks values that arrive when
    something happens. Durations are in seconds.
    """

    name: str
    port: str
    type: Type
    time: numpy.ndarray
    value: numpy.ndarray
    unread: numpy.ndarray
    is_event: bool
    is_output: bool

    @property
    def is_discrete(self) -> bool:
        """Whether it is one of few named values."""
        return isinstance(self.type, BoolType | EnumType)

    @property
    def changes(self) -> numpy.ndarray:
        """Positions of the values that differ from the previous one, or are read when that was not."""
        import numpy

        different = (self.value[1:] != self.value[:-1]) | (self.unread[1:] != self.unread[:-1])
        return numpy.flatnonzero(numpy.concatenate([[True], different])) if len(self.value) else numpy.array([], int)

    @property
    def written(self) -> numpy.ndarray:
        """Positions of the values to be written as text: the changes, and all values of an instant that has several."""
        import numpy

        together = self.time[1:] == self.time[:-1]
        several = numpy.flatnonzero(numpy.append(together, False) | numpy.append(False, together))
        return numpy.union1d(self.changes, several) if len(self.value) else self.changes

    @property
    def repeated(self) -> Series:
        """The values that are the same as the previous one: a held line does not show that they arrived."""
        import numpy

        again = numpy.setdiff1d(numpy.arange(len(self.value)), self.changes)
        return replaced(self, time=self.time[again], value=self.value[again], unread=self.unread[again])


def end_of(run: RunData) -> float:
    """Where the axis of time ends, in seconds; a run of 0 s has a width, too."""
    return run.outcome.time / 1e9 or 1e-6


def series_of(run: RunData) -> list[Series]:
    """The series of all ports, measured quantities before outputs; arrays and structs as their elements."""
    ports = sorted(run.network.external_ports, key=lambda port: port.direction == "out")
    return [series for port in ports for series in _of_port(run, port)]


def _of_port(run: RunData, port: ExternalPort) -> Iterator[Series]:
    import numpy

    signal = run.signals[port.name]
    unread = numpy.array(run.unread(port.name), dtype=bool)
    if len(unread) != len(signal.time):
        unread = numpy.zeros(len(signal.time), dtype=bool)
    for name, kind, _ in leaves(port.name, port.type):
        value = _part(signal.value, name[len(port.name) :])
        if isinstance(kind, TimeType):
            value = value / 1e9
        yield Series(name, port.name, kind, signal.time, value, unread, port.sampling is None, port.direction == "out")


def _part(values: numpy.ndarray, path: str) -> numpy.ndarray:
    """``[0]`` or ``.x`` of every value."""
    while path:
        if path.startswith("["):
            index, _, path = path[1:].partition("]")
            values = values[:, int(index)]
        else:
            end = min((at for at in (path.find(".", 1), path.find("[")) if at > 0), default=len(path))
            values, path = values[path[1:end]], path[end:]
    return values


def stairs(series: Series, end: float, *, unread: bool) -> tuple[numpy.ndarray, numpy.ndarray]:
    """The corners of the steps of what was read, or of what was not, with gaps (NaN) for the other."""
    import numpy

    time = numpy.append(series.time, max(end, series.time[-1]) if len(series.time) else end)
    value = series.value.astype(float)
    value[~numpy.isfinite(value)] = numpy.nan
    value[series.unread != unread] = numpy.nan
    return thinned(numpy.repeat(time, 2)[1:-1], numpy.repeat(value, 2), end)


def thinned(time: numpy.ndarray, value: numpy.ndarray, end: float) -> tuple[numpy.ndarray, numpy.ndarray]:
    """The curve with at most four points in each visible column: it looks the same."""
    import numpy

    if len(time) <= 4 * _COLUMNS:
        return time, value
    column = (time * (_COLUMNS / max(end, 1e-12))).astype(int)
    starts = numpy.flatnonzero(numpy.diff(column, prepend=-1))
    ends = numpy.append(starts[1:], len(time))
    kept: set[int] = set()
    for start, stop in zip(starts.tolist(), ends.tolist(), strict=True):
        part = value[start:stop]
        kept.update((start, stop - 1))
        known = numpy.flatnonzero(~numpy.isnan(part))
        if len(known):
            kept.update((start + int(known[part[known].argmin()]), start + int(known[part[known].argmax()])))
        if len(known) < len(part):
            kept.add(start + int(numpy.isnan(part).argmax()))
    chosen = numpy.array(sorted(kept))
    return time[chosen], value[chosen]


def apart(series: Series, end: float) -> Series:
    """Of values too close together to be distinguished, the position of the first."""
    import numpy

    column = (series.time * (_COLUMNS / max(end, 1e-12))).astype(int)
    kept = numpy.flatnonzero(numpy.diff(column, prepend=-1))
    return replaced(series, time=series.time[kept], value=series.value[kept], unread=series.unread[kept])


_QUANTITIES = {
    "rad": "angle (rad)",
    "V": "voltage (V)",
    "A": "current (A)",
    "rad/s": "speed (rad/s)",
    "m": "position (m)",
    "m/s": "speed (m/s)",
    "N": "force (N)",
    "N*m": "torque (N·m)",
    "K": "temperature (K)",
    "Pa": "pressure (Pa)",
    "W": "power (W)",
    "Hz": "frequency (Hz)",
}


def quantity(kind: Type) -> str:
    """The label of a vertical axis for a type."""
    if isinstance(kind, RealType):
        text = kind.unit.text
        return _QUANTITIES.get(text, f"({_typeset(text)})") if text else "dimensionless"
    return DURATION if isinstance(kind, TimeType) else WHOLE_NUMBERS


def _typeset(unit: str) -> str:
    return unit.translate(_SIGNS).replace("^2", "²").replace("^3", "³").replace("Ohm", "Ω")


DURATION = "duration"
"""The quantity of values of type ``time``; its axis is labelled with the unit that suits the values."""
WHOLE_NUMBERS = "value"
_SIGNS = {ord("*"): "·"}


def unit_of_time(longest: float) -> tuple[str, float]:
    """The unit in which durations up to ``longest`` seconds are read most easily, and how many of it make a second."""
    units = (("s", 1.0), ("ms", 1e3), ("µs", 1e6))
    return next((unit for unit in units if longest * unit[1] >= 1), ("ns", 1e9)) if longest else units[0]


def shortened(name: str, longest: int = 30) -> str:
    """A name shortened in the middle; both ends distinguish it from others."""
    return name if len(name) <= longest else f"{name[: longest // 2 - 1]}…{name[-(longest - longest // 2) :]}"
