"""One figure of a run: lanes of what runs, of events and of conditions above; below them curves, a panel for each unit,
with their names next to them.

A program of parallel parts that have modes and ports of their own has a column for each. Needs matplotlib
(``pip install "cspdiag[plot]"``), which is imported when a plot is made.
"""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cspdiag.base.files.whole import write_whole
from cspdiag.base.record import record, replaced
from cspdiag.simulate.record.modes import ModeGroup, mode_groups
from cspdiag.simulate.record.plot.lanes import (
    FAINT,
    LANE_HEIGHT,
    Lane,
    activity_lanes,
    are_events,
    draw_lanes,
    one_after_the_other,
    process_lanes,
    series_lane,
)
from cspdiag.simulate.record.plot.panels import Row, Sizes, coinciding_later, greatest, panels_of
from cspdiag.simulate.record.plot.series import (
    DURATION,
    WHOLE_NUMBERS,
    Series,
    apart,
    end_of,
    quantity,
    series_of,
    shortened,
    stairs,
    thinned,
    unit_of_time,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

    from cspdiag.simulate.record.run_data import RunData

_LINE_COLORS = ("#1f4e79", "#c0504d", "#4f8a3c", "#7f5fa0", "#b07d2b", "#3a8f99")
_DASHES = ((), (5, 1.5), (1, 1), (6, 1.5, 1, 1.5), (3, 1, 1, 1, 1, 1), (8, 3))
"""Colours are distinguishable on a screen, dashes in grey print as well."""
_THIN = "   ·   thin: never read"
_SAFE = "   ·   ▾ ▴ safe value, off the scale"
_MOST_COLUMNS = 3
_PANEL_HEIGHT = 1.7
_COLUMN_WIDTH = 4.8
_BEFORE = 0.005
"""The part of the width that is left free before 0 s, so marks at the beginning do not overlap the axis."""
_LINE_WIDTH = 1.2
_WIDER = 1.5
_STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "axes.titlesize": 10,
    "lines.linewidth": _LINE_WIDTH,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "legend.handlelength": 2.6,
    "text.parse_math": False,
    "svg.hashsalt": "cspdiag",
}


@record
class _Column:
    """A column: a part of the program, its lanes, and its curves by panel."""

    group: ModeGroup
    lanes: list[Lane]
    panels: dict[Row, list[Series]]
    variables: dict[Row, dict[str, Points]]
    events: list[float]
    has_unread: bool

    @property
    def rows(self) -> list[Row]:
        """The panels that have curves."""
        return list(dict.fromkeys([*self.panels, *self.variables]))


def plot(run: RunData, path: Path | None) -> Figure:
    """The figure; written whole to ``path`` (its suffix says the format) if given."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(_STYLE):  # type: ignore[arg-type]
        columns = _columns(run)
        rows = list(dict.fromkeys(row for column in columns for row in column.rows))
        units = list(dict.fromkeys(row.unit for row in rows))
        rows.sort(key=lambda row: units.index(row.unit))
        lanes = max(len(column.lanes) for column in columns)
        heights = [LANE_HEIGHT * lanes + 0.05] * bool(lanes) + [_PANEL_HEIGHT] * len(rows) or [_PANEL_HEIGHT]
        width = 1.6 + _COLUMN_WIDTH * len(columns) * (1 if len(columns) > 1 else 1.35)
        inches = _COLUMN_WIDTH * (0.62 if len(columns) > 1 else 1.12)
        figure = Figure(figsize=(width, 0.9 + sum(heights) + 0.1 * len(heights)), layout="constrained")
        grid = figure.add_gridspec(len(heights), len(columns), height_ratios=heights)
        shared: dict[int, Axes] = {}
        for position, column in enumerate(columns):
            first: Axes | None = None
            for row in range(len(heights)):
                is_lanes = bool(lanes) and row == 0
                axes = figure.add_subplot(
                    grid[row, position], sharex=first, sharey=None if is_lanes else shared.get(row)
                )
                first = first or axes
                axes.set_xlim(-_BEFORE * end_of(run), end_of(run))
                if is_lanes:
                    draw_lanes(axes, column.lanes, axes.get_xlim()[1], inches)
                elif rows:
                    shared.setdefault(row, axes)
                    _panel(run, axes, column, rows[row - bool(lanes)])
                axes.tick_params(axis="x", labelbottom=row == len(heights) - 1, length=3 * (row == len(heights) - 1))
            unit = _in_unit_of_time(axes.xaxis, run.outcome.time / 1e9)
            if not run.outcome.time:
                axes.set_xticks([0.0])
            assert first is not None
            first.set_title(shortened(column.group.name, 40), fontweight="bold")
            axes.set_xlabel(f"time ({unit})" + (_THIN if column.has_unread and position == 0 else ""))
        scaled = [
            _scale_to_the_run(axes, [figure.axes[row + at * len(heights)] for at in range(len(columns))])
            for row, axes in shared.items()
        ]
        if any(scaled):
            below = figure.axes[len(heights) - 1]
            below.set_xlabel(below.get_xlabel() + _SAFE)
        # The first layout decides the number of ticks, and the ticks decide the width of their labels.
        figure.draw_without_rendering()
        _widen(figure, inches, len(columns))
        if path is not None:
            write_whole(path, _rendered(figure, path.suffix.lstrip(".") or "svg"))
    return figure


def svg_text(run: RunData) -> str:
    """The figure as SVG."""
    return _rendered(plot(run, None), "svg").decode()


def _widen(figure: Figure, inches: float, columns: int) -> None:
    """Gives every column the width that decided which texts have room, however long the names next to it are."""
    missing = inches - min(axes.get_window_extent().width / figure.dpi for axes in figure.axes)
    if missing > 0:
        width, height = figure.get_size_inches()
        figure.set_size_inches(width + missing * columns, height)
        figure.draw_without_rendering()


def _rendered(figure: Figure, kind: str) -> bytes:
    import matplotlib as mpl

    buffer = io.BytesIO()
    metadata: dict[str, Any] = {"Date": None} if kind == "svg" else {}
    with mpl.rc_context(_STYLE):  # type: ignore[arg-type]
        figure.savefig(buffer, format=kind, dpi=160, metadata=metadata)
    return buffer.getvalue()


def _columns(run: RunData) -> list[_Column]:
    """The columns to show side by side; curves of one unit and of similar size share panels, variables with ports."""
    every = series_of(run)
    end = run.outcome.time / 1e9
    of_series = {series.name: (quantity(series.type), greatest(series, end)) for series in every}
    sizes = Sizes(of_series.values())
    columns = _columns_of_series(run, every, lambda series: sizes.of(*of_series[series.name]))
    units = list(dict.fromkeys(row.unit for column in columns for row in column.panels))
    found = [{unit: _variables(run, column.group, unit) for unit in units} for column in columns]
    sizes.add((unit, _greatest(line)) for lines in found for unit in units for line in lines[unit].values())
    return [
        replaced(column, variables=_by_panel(column.panels, lines, sizes))
        for column, lines in zip(columns, found, strict=True)
    ]


def _by_panel(
    panels: Iterable[Row], variables: Mapping[str, Mapping[str, Points]], sizes: Sizes
) -> dict[Row, dict[str, Points]]:
    """Add variables to panels with curves of their unit and size, or else in panels of their own."""
    first = {(row.unit, row.size): row for row in reversed([*panels])}
    found: dict[Row, dict[str, Points]] = {}
    for unit, lines in variables.items():
        for name, line in lines.items():
            kind = unit, sizes.of(unit, _greatest(line))
            found.setdefault(first.get(kind, Row(*kind, 0)), {})[name] = line
    return found


def _greatest(line: Points) -> float:
    return max((abs(value) for _, value in line if math.isfinite(value)), default=0.0)


def _columns_of_series(run: RunData, every: Sequence[Series], size: Callable[[Series], int]) -> list[_Column]:
    """The parallel parts, if each has modes and ports of its own to show; else everything in one column."""
    groups = mode_groups(run.network)
    with_ports = [group for group in groups if group.ports]
    if 1 < len(with_ports) <= _MOST_COLUMNS and all(len(group.modes) > 1 for group in with_ports):
        columns = [_column(run, group, [group], _used(every, group), size) for group in with_ports]
        if any(column.panels for column in columns):
            return columns
    ports = tuple(port.name for port in run.network.external_ports)
    modes = groups[0].modes if len(groups) == 1 else {}
    whole = ModeGroup(run.network.top, modes, ports)
    shown = [group for group in groups if len(groups) > 1 or len(group.modes) > 1]
    return [_column(run, whole, shown, every, size)]


def _used(every: Sequence[Series], group: ModeGroup) -> list[Series]:
    return [series for series in every if series.port in group.ports]


def _column(
    run: RunData, group: ModeGroup, parts: Sequence[ModeGroup], every: Sequence[Series], size: Callable[[Series], int]
) -> _Column:
    lanes = activity_lanes(run, parts)
    curves: list[Series] = []
    events: list[float] = []
    for series in every:
        if series.is_discrete or are_events(series):
            lanes.append(series_lane(run, series))
            if series.is_event:
                events += series.time.tolist() if len(series.time) <= _MOST_MARKS else []
            continue
        curves.append(series)
    panels = panels_of(curves, size)
    if not lanes and not panels:
        lanes = process_lanes(run)
    return _Column(group, lanes, panels, {}, events, any(bool(series.unread.any()) for series in every))


_MOST_MARKS = 20
"""A port with more events than this does not mark them behind the curves."""


def _panel(run: RunData, axes: Axes, column: _Column, row: Row) -> None:
    unit = row.unit
    end = axes.get_xlim()[1]
    for bar in one_after_the_other(run, column.group):
        axes.axvspan(bar.start, bar.end, color=bar.color, alpha=0.3, linewidth=0, zorder=0)
    for instant in column.events:
        axes.axvline(instant, color=FAINT, linewidth=0.5, linestyle=(0, (1, 2)), zorder=0.5)
    styles = ((color, _DASHES[at % len(_DASHES)]) for at, color in enumerate(_LINE_COLORS * 9))
    curves = column.panels.get(row, [])
    for series, below in zip(curves, coinciding_later(curves, end), strict=True):
        color, dashes = next(styles)
        # Curves that coincide are distinguished by their widths: the lower ones show on both sides of those above.
        wide: dict[str, Any] = {"linewidth": _LINE_WIDTH + _WIDER * min(below, 4), "alpha": 0.55} if below else {}
        label = shortened(series.name) if len(series.time) else f"{shortened(series.name)} (no value)"
        is_read = not series.unread.all() or not len(series.time)
        if is_read:
            axes.plot(
                *stairs(series, end, unread=False),
                label=label,
                color=color,
                linestyle=(0, dashes),
                **wide,
                **_mark(series),
            )
        if series.unread.any():
            # The length of dashes is measured in widths of their line.
            thin: dict[str, Any] = {
                "color": color,
                "linewidth": 0.45,
                "linestyle": (0, tuple(2.5 * part for part in dashes)),
            }
            axes.plot(*stairs(series, end, unread=True), label=None if is_read else label, **thin, **_mark(series))
        if series.is_event:
            again = apart(series.repeated, end)
            axes.plot(again.time, again.value, linestyle="", marker="|", markersize=5, color=color)
    for name, line in column.variables.get(row, {}).items():
        color, dashes = next(styles)
        axes.plot(
            *_steps(line, end), label=shortened(name), color=color, linestyle=(0, dashes), linewidth=0.8, zorder=2.5
        )
    if unit == DURATION:
        axes.set_ylabel(f"{unit} ({_in_unit_of_time(axes.yaxis, max(map(abs, axes.get_ylim())))})")
    else:
        axes.set_ylabel(unit)
        axes.locator_params(axis="y", integer=unit == WHOLE_NUMBERS)
    if not any(len(series.time) for series in column.panels.get(row, ())) and row not in column.variables:
        axes.set_yticks([])
    axes.grid(axis="y", linewidth=0.3, color="#bbbbbb")
    if axes.lines:
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0)


def _scale_to_the_run(axes: Axes, row: Sequence[Axes]) -> bool:
    """Keep the safe values that outputs are set to at the end from deciding the scale of everything else."""
    import numpy

    lines = [line for panel in row for line in panel.lines if line.get_transform() == panel.transData]
    corners = numpy.concatenate(
        [numpy.asarray(line.get_xydata(), dtype=float) for line in lines] or [numpy.empty((0, 2))]
    )
    corners = corners[numpy.isfinite(corners).all(axis=1)]
    during = corners[corners[:, 0] < axes.get_xlim()[1], 1]
    if not len(during):
        return False
    low, high = during.min(), during.max()
    if not 0 < high - low < _LEAST_PART * numpy.ptp(corners[:, 1]):
        return False
    low, high = low - 0.05 * (high - low), high + 0.05 * (high - low)
    axes.set_ylim(low, high)
    for panel in row:
        _mark_off_scale(panel, low, high)
    return True


def _mark_off_scale(panel: Axes, low: float, high: float) -> None:
    """Draw a mark at the edge for each curve that ends off the scale."""
    import numpy

    for line in [each for each in panel.lines if each.get_transform() == panel.transData]:
        corners = numpy.asarray(line.get_xydata(), dtype=float)
        end, value = corners[-1] if len(corners) else (0.0, math.nan)
        if math.isfinite(value) and not low <= value <= high:
            place, marker = (low, "v") if value < low else (high, "^")
            panel.plot([end], [place], linestyle="", marker=marker, markersize=4, color=line.get_color(), clip_on=False)


_LEAST_PART = 0.75
"""The part of the height of a panel that shows what happened during the run."""


def _in_unit_of_time(axis: Axis, longest: float) -> str:
    """Label an axis of seconds in the unit that suits ``longest``, a number of seconds, and return that unit."""
    from matplotlib.ticker import FuncFormatter

    unit, count = unit_of_time(longest)
    axis.set_major_formatter(FuncFormatter(lambda seconds, _: f"{round(seconds * count, 9):g}"))
    return unit


def _mark(series: Series) -> dict[str, Any]:
    """The marker of a curve: a single value at the end of a run has no line."""
    if len(series.time) != 1 or not math.isfinite(float(series.value[0])):
        return {}
    return {"marker": "o", "markersize": 3, "markevery": [0], "clip_on": False}


Points = list[tuple[float, float]]


def _steps(line: Points, end: float) -> tuple[Any, Any]:
    import numpy

    time, value = numpy.array(line).T
    return thinned(numpy.repeat(time, 2)[1:], numpy.repeat(value, 2)[:-1], end)


def _variables(run: RunData, group: ModeGroup, unit: str) -> dict[str, Points]:
    """Variables of the group's quantity; those of one name in several modes make one line, with gaps between."""
    return dict(_sorted_lines(run, group, unit))


def _sorted_lines(run: RunData, group: ModeGroup, unit: str) -> Iterator[tuple[str, Points]]:
    prefixes = tuple({prefix for path in group.modes for prefix in (f"{path}.", f"{path.rpartition('.')[0]}.")})
    prefixes = prefixes or (f"{group.name}.",)
    found: dict[str, Points] = {}
    for path, points in run.variables.items():
        if path.startswith(prefixes) and quantity(run.types[path]) == unit:
            line = found.setdefault(path.rpartition(".")[2], [])
            line += [(time / 1e9, value) for time, value in points]
            if path.startswith(tuple(f"{mode}." for mode in group.modes)):
                line.append((points[-1][0] / 1e9, math.nan))
            else:
                line.append((run.outcome.time / 1e9, points[-1][1]))
    for name, line in found.items():
        yield name, sorted(line, key=lambda point: point[0])
