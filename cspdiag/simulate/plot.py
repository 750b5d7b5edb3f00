"""One figure of a run: a column for each part of the program that runs in parallel, a row for each unit, the modes behind.

Needs matplotlib (``pip install "cspdiag[plot]"``), which is imported when a plot is made.
"""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cspdiag.model.types import BoolType, EnumType, IntType, RealType, Type
from cspdiag.simulate.files import readable, write_whole
from cspdiag.simulate.modes import ModeGroup, mode_groups

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from cspdiag.simulate.result import Run

_MODE_COLORS = ("#dbe9f6", "#e3f1dc", "#fdebd3", "#eee3f3", "#f9dfe1", "#e4e4e4")
_LINE_COLORS = ("#1f4e79", "#c0504d", "#4f8a3c", "#7f5fa0", "#b07d2b", "#3a8f99")
_STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "axes.titlesize": 10,
    "lines.linewidth": 1.1,
    "legend.framealpha": 0.7,
    "legend.edgecolor": "none",
    "legend.fontsize": 8,
    "svg.hashsalt": "cspdiag",
}


def plot(run: Run, path: Path | None) -> Figure:
    """The figure; written whole to ``path`` (its suffix says the format) if given."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(_STYLE):  # type: ignore[arg-type]
        groups = _columns(run)
        rows = _rows(run, groups)
        figure = Figure(figsize=(max(5.2, 4.6 * len(groups)), 1.1 + 1.75 * max(2, len(rows))), layout="constrained")
        heights = [0.4 if unit == _TRUTH else 1.0 for unit in rows] or [1.0]
        axes = figure.subplots(
            len(heights), len(groups), sharex=True, sharey="row", squeeze=False, height_ratios=heights
        )
        if not rows:
            _activities(run, axes[0, 0])
        for column, group in enumerate(groups):
            for row, unit in enumerate(rows):
                _panel(run, axes[row, column], group, unit, rows[unit], top=row == 0)
                if column == 0:
                    axes[row, column].set_ylabel(unit or "value")
            _name_modes(run, axes[0, column], group)
            axes[-1, column].set_xlabel("time (s)")
        if path is not None:
            write_whole(path, _rendered(figure, path.suffix.lstrip(".") or "svg"))
    return figure


def _columns(run: Run) -> Sequence[ModeGroup]:
    """The parallel parts, if each has modes and ports of its own to show; else everything in one column."""
    groups = [group for group in mode_groups(run.network) if group.ports]
    if groups and all(len(group.modes) > 1 for group in groups):
        return groups
    modes = groups[0].modes if len(groups) == 1 and len(groups[0].modes) > 1 else {}
    return [ModeGroup(run.network.top, modes, tuple(port.name for port in run.network.external_ports))]


def svg_text(run: Run) -> str:
    """The figure as SVG."""
    return _rendered(plot(run, None), "svg").decode()


def _rendered(figure: Figure, kind: str) -> bytes:
    buffer = io.BytesIO()
    metadata: dict[str, Any] = {"Date": None} if kind == "svg" else {}
    figure.savefig(buffer, format=kind, dpi=160, metadata=metadata)
    return buffer.getvalue()


def _rows(run: Run, groups: Sequence[ModeGroup]) -> Mapping[str, set[str]]:
    """Signals by what is on the vertical axis, measured quantities before outputs."""
    used = {name for group in groups for name in group.ports}
    rows: dict[str, set[str]] = {}
    for port in sorted(run.network.external_ports, key=lambda port: port.direction == "out"):
        signal = run.signals[port.name]
        a_line = port.period is not None or isinstance(port.type, RealType)
        if port.name in used and a_line and len(signal.time) and signal.value.dtype != object:
            rows.setdefault(_quantity(port.type), set()).add(port.name)
    return rows


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


def _quantity(kind: Type) -> str:
    if isinstance(kind, RealType) and kind.unit.text:
        return _QUANTITIES.get(kind.unit.text, f"({kind.unit.text})")
    match kind:
        case RealType():
            return "dimensionless"
        case BoolType():
            return _TRUTH
        case EnumType():
            return kind.name
        case _:
            return "value"


_TRUTH = "condition"


def _name_values(run: Run, axes: Axes, names: set[str]) -> None:
    """Truth values and literals on the vertical axis by their names."""
    kind = run.signals[min(names)].type
    literals = ("false", "true") if isinstance(kind, BoolType) else kind.literals if isinstance(kind, EnumType) else ()
    if literals:
        axes.set_yticks(range(len(literals)), literals)
        axes.set_ylim(-0.1, len(literals) - 0.9)


def _panel(run: Run, axes: Axes, group: ModeGroup, unit: str, names: set[str], top: bool) -> None:
    for activity in run.activities:
        if activity.path in group.modes:
            end = run.outcome.time if activity.end is None else activity.end
            position = list(group.modes).index(activity.path)
            axes.axvspan(
                activity.start / 1e9, end / 1e9, color=_MODE_COLORS[position % len(_MODE_COLORS)], linewidth=0, zorder=0
            )
    color = iter(_LINE_COLORS * 4)
    for name in group.ports:
        if name in names:
            times, values = _held(run, name)
            axes.plot(times, values, drawstyle="steps-post", label=name, color=next(color))
    for name, (times, values) in _variables(run, group, unit).items():
        axes.plot(times, values, drawstyle="steps-post", label=name, color=next(color), linewidth=0.9, zorder=1.5)
    for instant, label in _events(run, group):
        axes.axvline(instant, color="#555555", linewidth=0.7, linestyle=(0, (3, 2)))
        if top:
            axes.annotate(
                label, (instant, 1), xycoords=("data", "axes fraction"), xytext=(-2, -3),
                textcoords="offset points", rotation=90, va="top", ha="right", fontsize=6.5, color="#555555",
            )  # fmt: skip
    _name_values(run, axes, names)
    axes.set_xlim(0, max(run.outcome.time / 1e9, 1e-9))
    axes.grid(axis="y", linewidth=0.3, color="#bbbbbb")
    if axes.lines:
        axes.legend(loc="best")


def _held(run: Run, name: str) -> tuple[list[float], list[float]]:
    """A signal with its last value held to the end of the run."""
    signal = run.signals[name]
    times, values = signal.time.tolist(), signal.value.astype(float).tolist()
    return [*times, run.outcome.time / 1e9], [*values, *values[-1:]]


_MOST_EVENTS = 20
"""More changes than this are a signal, not events to be marked."""


def _events(run: Run, group: ModeGroup) -> list[tuple[float, str]]:
    """Instants at which event ports of whole numbers, truth values or literals changed, with what they changed to."""
    labels: dict[float, list[str]] = {}
    for port in run.network.external_ports:
        if port.name in group.ports and port.period is None and isinstance(port.type, IntType | BoolType | EnumType):
            signal = run.signals[port.name]
            changes = [
                position
                for position in range(len(signal.value))
                if position == 0 or signal.value[position] != signal.value[position - 1]
            ]
            if len(changes) <= _MOST_EVENTS:
                for position in changes:
                    shown = readable(signal.value[position], port.type)
                    if isinstance(port.type, BoolType):
                        shown = "true" if shown else "false"
                    labels.setdefault(float(signal.time[position]), []).append(f"{port.name} = {shown}")
    return [(instant, ", ".join(texts)) for instant, texts in labels.items()]


def _variables(run: Run, group: ModeGroup, quantity: str) -> dict[str, tuple[list[float], list[float]]]:
    """Variables of the group's quantity; those of one name in several modes make one line, with gaps between."""
    prefixes = tuple({prefix for path in group.modes for prefix in (f"{path}.", f"{path.rpartition('.')[0]}.")})
    prefixes = prefixes or (f"{group.name}.",)
    found: dict[str, list[tuple[float, float]]] = {}
    for path, points in run.variables.items():
        if path.startswith(prefixes) and _quantity(run.types[path]) == quantity:
            line = found.setdefault(path.rpartition(".")[2], [])
            line += [(time / 1e9, value) for time, value in points]
            if path.startswith(tuple(f"{mode}." for mode in group.modes)):
                line.append((points[-1][0] / 1e9, math.nan))
            else:
                line.append((run.outcome.time / 1e9, points[-1][1]))
    return {name: tuple(zip(*sorted(line, key=lambda point: point[0]), strict=True)) for name, line in found.items()}  # type: ignore[misc]


_MOST_ACTIVITIES = 40
"""A person does not read more bars than this; the first ones are shown."""


def _activities(run: Run, axes: Axes) -> None:
    """A bar for each process while it runs, for a program without signals."""
    paths = list(dict.fromkeys(activity.path for activity in run.activities))[:_MOST_ACTIVITIES]
    for activity in run.activities:
        if activity.path in paths:
            end = run.outcome.time if activity.end is None else activity.end
            axes.barh(
                paths.index(activity.path),
                (end - activity.start) / 1e9,
                left=activity.start / 1e9,
                color=_MODE_COLORS[0],
                edgecolor=_LINE_COLORS[0],
                linewidth=0.6,
            )
    axes.set_yticks(range(len(paths)), paths, fontsize=6.5)
    axes.invert_yaxis()


def _name_modes(run: Run, axes: Axes, group: ModeGroup) -> None:
    axes.set_title(group.name, pad=18, fontweight="bold")
    for activity in run.activities:
        if activity.path in group.modes:
            end = run.outcome.time if activity.end is None else activity.end
            axes.annotate(
                group.modes[activity.path], ((activity.start + end) / 2e9, 1), xycoords=("data", "axes fraction"),
                xytext=(0, 4), textcoords="offset points", ha="center", fontsize=7, color="#444444",
            )  # fmt: skip
