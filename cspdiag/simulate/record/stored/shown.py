"""What a recording has, as text and as a figure."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cspdiag.base.errors import missing_package
from cspdiag.model.types import RealType, Type
from cspdiag.runtime.kernel.durations import shown
from cspdiag.simulate.record.leaves import leaf_of_each, leaves
from cspdiag.simulate.record.stored.parameters import shown_values

if TYPE_CHECKING:
    from cspdiag.simulate.record.stored.described import RecordedPort
    from cspdiag.simulate.record.stored.recording import StoredRecording


_MOST_CHANGES = 100
"""If there are more values of parameters than this, the rest is counted."""


def text_of(recording: StoredRecording) -> str:
    """Several lines: the format, the run, how it ended, and a line for each signal."""
    import numpy

    counts = [0] * len(recording.head.ports)
    spans: list[tuple[int, int] | None] = [None] * len(recording.head.ports)
    lows: dict[int, float] = {}
    highs: dict[int, float] = {}
    for blocks in recording.blocks():
        for block in blocks:
            at, time, value = block.port, block.time, block.value
            counts[at] += len(time)
            first = spans[at]
            spans[at] = (int(time[0]) if first is None else first[0], int(time[-1]))
            if value.ndim == 1 and value.dtype.kind in "fi":
                lows[at] = min(lows.get(at, numpy.inf), value.min())
                highs[at] = max(highs.get(at, -numpy.inf), value.max())
    head = recording.head
    of = f", {head.process}{f' in {head.environment}' if head.environment else ''}" if head.process else ""
    rows = [f"{recording.path}: {recording.format}{of}"]
    if not recording.whole:
        rows.append(f"  not whole: the run was cut off; it has everything up to {shown(recording.time)}")
    else:
        rows.append(f"  {recording.ended + ' at ' if recording.ended else 'until '}{shown(recording.time)}")
    cells = [("signal", "type", "every", "values", "first", "last", "least", "greatest")]
    for position, port in enumerate(head.ports):
        span = spans[position]
        low, high = lows.get(position), highs.get(position)
        cells.append(
            (
                port.name,
                _type(port, recording),
                shown(port.period) if port.period else "",
                str(counts[position]),
                "" if span is None else shown(span[0]),
                "" if span is None else shown(span[1]),
                "" if low is None else f"{low:.6g}",
                "" if high is None else f"{high:.6g}",
            )
        )
    widths = [max(len(row[column]) for row in cells) for column in range(len(cells[0]))]
    for row in cells:
        rows.append("  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
    rows += _parameters(recording)
    return "\n".join(rows) + "\n"


def _parameters(recording: StoredRecording) -> Iterator[str]:
    """The first values of the parameters, and their changes."""
    values = shown_values(recording)
    if not values:
        return
    yield "  parameters, and their changes"
    width = max(len(shown(time)) for time, _, _ in values)
    for time, name, value in values[:_MOST_CHANGES]:
        yield f"  {shown(time).rjust(width)}  {name} = {value}"
    if len(values) > _MOST_CHANGES:
        yield f"  … and {len(values) - _MOST_CHANGES} more"


def _type(port: RecordedPort, recording: StoredRecording) -> str:
    return str(port.type) if recording.typed else ""


def plot(recording: StoredRecording, path: Path) -> None:
    """A figure: a panel for each unit, with the numbers of all signals over time. Raises MissingPackageError."""
    try:
        from matplotlib import rc_context
        from matplotlib.figure import Figure
    except ImportError:
        raise missing_package("matplotlib", "plot") from None
    import numpy

    panels: dict[str, list[tuple[str, Any, Any]]] = {}
    for port in recording.head.ports:
        time, value = recording.values(port.name)
        for name, kind, number in leaves(port.name, port.type):
            own = numpy.asarray(leaf_of_each(value, number), dtype=float)
            panels.setdefault(_axis(kind), []).append((name, time / 1e9, own))
    with rc_context({"svg.hashsalt": "cspdiag", "font.size": 9, "text.parse_math": False}):
        figure = Figure(figsize=(9, 0.6 + 1.9 * max(1, len(panels))), layout="constrained")
        axes = figure.subplots(max(1, len(panels)), 1, sharex=True, squeeze=False)[:, 0]
        for panel, (axis, curves) in zip(axes, panels.items(), strict=False):
            for name, instants, own in curves:
                panel.step(instants, own, where="post", linewidth=1, label=name)
            panel.set_ylabel(axis)
            panel.legend(loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False)
        axes[-1].set_xlabel("time (s)")
        figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def _axis(kind: Type) -> str:
    return str(kind.unit) if isinstance(kind, RealType) else str(kind)
