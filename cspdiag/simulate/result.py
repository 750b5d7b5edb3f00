"""The result of a run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cspdiag.simulate.record.recorder import Communication
from cspdiag.simulate.record.run_data import RunData, Signal

if TYPE_CHECKING:
    import numpy
    from matplotlib.figure import Figure


class Run(RunData):
    """A run of a program: why it ended, what was communicated and when, which process ran when.

    ``signals`` has the external ports under their names and the internal channels under their hierarchical names (``Jiwy.horizontal.status``).
    ``run["control_horizontal"]`` is an array of values, ``run.time("control_horizontal")`` the array of their instants in seconds.
    """

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
        """Values of a signal; KeyError with the known names if there is none of that name."""
        return self._signal(name).value

    def time(self, name: str) -> numpy.ndarray:
        """Instants of a signal in seconds."""
        return self._signal(name).time

    def _signal(self, name: str) -> Signal:
        try:
            return self.signals[name]
        except KeyError:
            raise KeyError(f"no signal {name!r}; there are: {', '.join(self.signals)}") from None

    @property
    def events(self) -> Sequence[Communication]:
        """All communications in order."""
        return self.communications

    def summary(self) -> str:
        """Why and when the run ended, missed samples, real-time figures."""
        from cspdiag.simulate.record.summary import summary

        return summary(self)

    def to_csv(self, path: str | Path) -> None:
        """Write the external ports as CSV (format: ``cspdiag run --record``)."""
        from cspdiag.simulate.record.files import csv_text, write_whole

        write_whole(Path(path), csv_text(self).encode())

    def to_npz(self, path: str | Path) -> None:
        """Write the external ports as a numpy archive."""
        from cspdiag.simulate.record.files import npz_bytes, write_whole

        write_whole(Path(path), npz_bytes(self))

    def to_trace(self, path: str | Path) -> None:
        """Write Chrome trace events (``.json``) or the plain trace (``.jsonl``)."""
        from cspdiag.simulate.record.chrome_trace import chrome_trace_text
        from cspdiag.simulate.record.files import plain_trace_text, write_whole

        make = plain_trace_text if Path(path).suffix == ".jsonl" else chrome_trace_text
        write_whole(Path(path), make(self).encode())

    def plot(self, path: str | Path | None = None) -> Figure:
        """One figure of set-points, measurements, outputs and modes over time; written to ``path`` if given.

        Raises ImportError with the command to install matplotlib if it is missing.
        """
        from cspdiag.simulate.record.plot import plot

        return plot(self, None if path is None else Path(path))

    def _repr_svg_(self) -> str:
        from cspdiag.simulate.record.plot import svg_text

        return svg_text(self)
