"""A figure of a sweep: a panel for each measure, over the name with the most values, a line for each combination of the
others; or an area in colours, if two names have many.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from cspdiag.base.errors import ArgumentError, missing_package
from cspdiag.base.files.whole import whole_file
from cspdiag.sweep.columns import units_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    from cspdiag.sweep.axes import Axis, Cell, Grid
    from cspdiag.sweep.measures import Measures

ENDINGS = (".svg", ".png", ".pdf")
_MOST_LINES = 8
"""More combinations of two names are shown as an area."""
_COLOURS = 10
_STYLES = ("-", "--", ":", "-.")
_LEGEND_WIDTH = 100
"""The characters of a line of the legend."""

Rows: TypeAlias = "Sequence[Mapping[str, Cell | None]]"


def plot(grid: Grid, measures: Measures, rows: Rows, path: Path | None) -> Figure:
    """The figure of a table, written to ``path`` if given. Raises MissingPackageError and ArgumentError."""
    if path is not None and path.suffix not in ENDINGS:
        raise ArgumentError(f"a plot is written as {', '.join(ENDINGS)}, not as {path.name}")
    try:
        from matplotlib import rc_context
        from matplotlib.figure import Figure
    except ImportError:
        raise missing_package("matplotlib", "plot") from None
    names = measures.names
    units = units_of(grid, measures)
    varied = [axis for axis in grid.axes if len(axis.values) > 1]
    if not names or not varied:
        raise ArgumentError("a plot of a sweep needs a name with several values and a measure")
    with rc_context({"svg.hashsalt": "cspdiag", "text.parse_math": False, "axes.spines.top": False,
                     "axes.spines.right": False, "font.size": 9}):  # fmt: skip
        figure = Figure(figsize=(6.4, 0.6 + 2.6 * len(names)), layout="constrained")
        panels = figure.subplots(len(names), 1, squeeze=False, sharex=True)[:, 0]
        lines: dict[str, Line2D] = {}
        for panel, name in zip(panels, names, strict=True):
            _panel(rows, panel, name, varied, units, lines)
            panel.label_outer()
        if len(lines) > 1:
            _legend(figure, lines)
        if path is not None:
            with whole_file(path) as file:
                metadata: dict[str, Any] = {"Date": None} if path.suffix == ".svg" else {}
                figure.savefig(file, format=path.suffix[1:], dpi=150, metadata=metadata)
    return figure


def _panel(
    rows: Rows,
    panel: Axes,
    name: str,
    varied: Sequence[Axis],
    units: Mapping[str, str],
    lines: dict[str, Line2D],
) -> None:
    """Draw a measure; the lines for the legend, which all panels have in common, are added to ``lines``."""
    longest = max(varied, key=lambda axis: len(axis.values))
    others = [axis for axis in varied if axis is not longest]
    combinations: dict[tuple[Any, ...], list[tuple[Any, Any]]] = {}
    for row in rows:
        key = tuple(row[axis.name] for axis in others)
        combinations.setdefault(key, []).append((row[longest.name], row[name]))
    panel.set_xlabel(_with_unit(longest.name, units))
    if len(combinations) > _MOST_LINES and len(others) == 1 and _are_numbers(longest) and _are_numbers(others[0]):
        _area(rows, panel, name, longest, others[0], units)
        return
    panel.set_ylabel(_with_unit(name, units))
    for number, (key, points) in enumerate(combinations.items()):
        values = [float("nan") if value is None else value for _, value in points]
        (line,) = panel.plot(
            [_shown_place(place) for place, _ in points],
            values,
            color=f"C{number % _COLOURS}",
            linestyle=_STYLES[number // _COLOURS % len(_STYLES)],
            marker=".",
            linewidth=1.2,
        )
        if len(combinations) <= 2 * _MOST_LINES and any(isfinite(value) for value in values):
            label = ", ".join(
                f"{axis.name} = {_shown(value)} {units.get(axis.name, '')}".rstrip()
                for axis, value in zip(others, key, strict=True)
            )
            lines.setdefault(label, line)


def _legend(figure: Figure, lines: Mapping[str, Line2D]) -> None:
    """A legend below the panels, for which the figure becomes higher."""
    columns = max(1, min(len(lines), _LEGEND_WIDTH // (max(map(len, lines)) + 6)))
    figure.set_figheight(figure.get_figheight() + 0.2 * -(-len(lines) // columns))
    figure.legend(
        list(lines.values()), list(lines), loc="outside lower center", ncols=columns, frameon=False, fontsize=8
    )


def _area(rows: Rows, panel: Axes, name: str, across: Axis, up: Axis, units: Mapping[str, str]) -> None:
    cells: dict[tuple[Any, Any], Any] = {(row[across.name], row[up.name]): row[name] for row in rows}
    places: Any = sorted({place for place, _ in cells}), sorted({height for _, height in cells})
    values = [
        [float("nan") if (value := cells[place, height]) is None else value for place in places[0]]
        for height in places[1]
    ]
    colours = panel.pcolormesh(*places, values, shading="nearest")
    bar = panel.figure.colorbar(colours, ax=panel)
    bar.set_label(_with_unit(name, units))
    panel.set_ylabel(_with_unit(up.name, units))


def _are_numbers(axis: Axis) -> bool:
    return all(isinstance(value.cell, int | float) and not isinstance(value.cell, bool) for value in axis.values)


def _shown_place(place: Any) -> Any:
    return str(place).lower() if isinstance(place, bool) else place


def _shown(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(_shown_place(value))


def _with_unit(name: str, units: Mapping[str, str]) -> str:
    return f"{name} [{units[name]}]" if name in units else name
