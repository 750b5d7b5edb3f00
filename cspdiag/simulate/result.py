"""The result of a run."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from cspdiag.base.errors import ArgumentError, CspdiagError, file_errors, missing_package
from cspdiag.runtime.kernel.exceptions import described
from cspdiag.simulate.record.recorder import Communication
from cspdiag.simulate.record.run_data import RunData, Signal

if TYPE_CHECKING:
    import numpy
    import pandas
    import xarray
    from matplotlib.figure import Figure


_PICTURES = (".svg", ".png", ".pdf")


class UnknownSignalError(CspdiagError, KeyError):
    """A run has no signal of that name; the message lists those that exist."""

    def __str__(self) -> str:
        return str(self.args[0])


class RunError(CspdiagError):
    """A run ended unsuccessfully: with an exception of the program, which is the cause of this one, or in
    a deadlock.
    """


class Run(RunData):
    """A run of a program: why it ended, what was communicated and when, which process ran when.

    ``signals`` has the external ports under their names and the internal channels under their hierarchical names
    (``Jiwy.horizontal.status``). ``run["control_horizontal"]`` is an array of values,
    ``run.time("control_horizontal")`` the array of their instants in seconds.
    """

    def unread(self, name: str) -> Sequence[bool]:
        """For each sample of a sampled input, whether it was not read before the next one arrived. Raises
        UnknownSignalError.
        """
        self._signal(name)
        return super().unread(name)

    def __repr__(self) -> str:
        where = f" in {self.environment.name}" if self.environment is not None else ""
        return f"<Run of {self.network.top}{where}: {self.summary().splitlines()[0].partition(': ')[2]}>"

    def __iter__(self) -> Iterator[str]:
        """Names of the signals."""
        return iter(self.signals)

    def __contains__(self, name: object) -> bool:
        """Whether there is a signal of that name."""
        return name in self.signals

    def __getitem__(self, name: str) -> numpy.ndarray:
        """Values of a signal. Raises UnknownSignalError, a KeyError, which lists the known names."""
        return self._signal(name).value

    def time(self, name: str) -> numpy.ndarray:
        """Instants of a signal in seconds."""
        return self._signal(name).time

    def _signal(self, name: str) -> Signal:
        if not isinstance(name, str):
            raise TypeError(f"the name of a signal is a str, not {type(name).__name__}")
        try:
            return self.signals[name]
        except KeyError:
            raise UnknownSignalError(f"no signal {name!r}; there are: {', '.join(self.signals)}") from None

    @property
    def events(self) -> Sequence[Communication]:
        """All communications in order."""
        return self.communications

    def raise_if_unsuccessful(self) -> None:
        """Raise RunError if the run failed or ended in a deadlock."""
        try:
            self.outcome.raise_if_unsuccessful()
        except Exception as problem:
            raise RunError(f"{self!r}\n{described(problem)}") from problem

    def summary(self) -> str:
        """Why and when the run ended, missed samples, real-time figures."""
        from cspdiag.simulate.record.summary import summary

        return summary(self)

    def to_csv(self, path: str | Path) -> None:
        """Write the external ports as CSV (format: ``cspdiag run --record``)."""
        from cspdiag.base.files.whole import whole_file
        from cspdiag.simulate.record.files import csv_parts

        with file_errors(), whole_file(path) as file:
            file.writelines(part.encode() for part in csv_parts(self))

    def to_dataframe(self, signals: Iterable[str] | None = None) -> pandas.DataFrame:
        """A table of signals, by default of the external ports, indexed by the time in seconds: a row for each instant
        at which one had a new value.

        Values are held between, and missing (NaN, NA) before the first. Arrays and structs have a column for each
        number (``gyro[0]``, ``pose.x``), enums are categories. ``attrs`` has ``units`` and ``periods`` (in seconds, of
        sampled ports) by column, ``process``, ``environment`` and how it ``ended``.

        Raises UnknownSignalError, and MissingPackageError with the command to install pandas if it is missing.
        """
        from cspdiag.simulate.record.frames import to_dataframe

        return to_dataframe(self, self._names(signals))

    def to_xarray(self, signals: Iterable[str] | None = None) -> xarray.Dataset:
        """The same as ``to_dataframe`` as a data set over ``time``: variables have ``units``, ``period`` (in seconds,
        if sampled) and ``type`` as attributes.

        Arrays of numbers are one variable, with an axis of its own; enums are numbers, which ``flag_meanings``
        explains.

        Raises UnknownSignalError, and MissingPackageError with the command to install xarray if it is missing.
        """
        from cspdiag.simulate.record.frames import to_xarray

        return to_xarray(self, self._names(signals))

    def _names(self, signals: Iterable[str] | None) -> list[str]:
        if signals is None:
            return [port.name for port in self.network.external_ports]
        names = [signals] if isinstance(signals, str) else list(dict.fromkeys(signals))
        for name in names:
            self._signal(name)
        return names

    def to_npz(self, path: str | Path) -> None:
        """Write the external ports as a numpy archive."""
        from cspdiag.base.files.whole import whole_file
        from cspdiag.simulate.record.files import write_npz

        with file_errors(), whole_file(path) as file:
            write_npz(self, file)

    def to_trace(self, path: str | Path) -> None:
        """Write Chrome trace events (``.json``) or the plain trace (``.jsonl``)."""
        from cspdiag.base.files.whole import write_whole
        from cspdiag.simulate.record.chrome_trace import chrome_trace_text
        from cspdiag.simulate.record.files import plain_trace_text

        make = plain_trace_text if Path(path).suffix == ".jsonl" else chrome_trace_text
        with file_errors():
            write_whole(Path(path), make(self).encode())

    def plot(self, path: str | Path | None = None) -> Figure:
        """One figure of set-points, measurements, outputs and modes over time; written to ``path`` if given.

        Raises MissingPackageError, an ImportError, with the command to install matplotlib if it is missing,
        ArgumentError for a file name that does not end in .svg, .png or .pdf, and FileError if the file cannot be
        written.
        """
        from cspdiag.simulate.record.plot.figure import plot

        if find_spec("matplotlib") is None:
            raise missing_package("matplotlib", "plot")
        if path is not None and Path(path).suffix.lower() not in _PICTURES:
            raise ArgumentError(f"a plot is written as {', '.join(_PICTURES)}, not as {Path(path).name}")
        with file_errors():
            return plot(self, None if path is None else Path(path))

    def _repr_svg_(self) -> str:
        from cspdiag.simulate.record.plot.figure import svg_text

        return svg_text(self)
