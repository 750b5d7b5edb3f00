"""Lanes of a plot, as a logic analyser has them: what runs when, events, truth values and literals, each in its own
row.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from cspdiag.base.record import record, replaced
from cspdiag.model.types import BoolType, EnumType
from cspdiag.simulate.record.modes import ModeGroup
from cspdiag.simulate.record.plot.labels import Event, labels_of
from cspdiag.simulate.record.plot.series import Series, apart, end_of, shortened, stairs

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from cspdiag.simulate.record.run_data import RunData

MODE_COLORS = ("#dbe9f6", "#a9d18e", "#e8a35c", "#d9cbe8", "#e99aa0", "#9a9a9a")
"""They differ in lightness, too, for greyscale printing."""
RUNNING = "#faf6e8"
"""The colour of a bar that only shows that something runs; no mode has it."""
LITERAL_COLORS = ("#f1f6fb", "#bcd3ea", "#8bb0d6", "#dddddd", "#b9b9b9", "#979797")
"""Greys without a hue: a literal may be called ``green``."""
INK = "#1f4e79"
FAINT = "#666666"
LANE_HEIGHT = 0.27
"""Inches."""
_LOW, _HIGH = 0.84, 0.2
"""The edges of a lane of height 1, measured from the top."""
_NARROW = 1 / 700
"""Part of the width below which a bar is drawn together with its neighbour."""
_MOST_LANES = 40
"""More bars than this are unreadable; the first ones are shown."""


@record(order=True)
class Bar:
    """An interval from one instant to another, in seconds, with its text and colour, and whether it is drawn thin."""

    start: float
    end: float
    text: str = ""
    color: str = MODE_COLORS[0]
    thin: bool = False


@record
class Lane:
    """A row: bars, or the steps of a truth value, or events with their values; ``arrivals`` are the instants at which
    the values behind bars arrived.
    """

    name: str
    bars: Sequence[Bar] = ()
    truth: Series | None = None
    events: Sequence[Event] = ()
    arrivals: Sequence[float] = ()


def activity_lanes(run: RunData, groups: Sequence[ModeGroup]) -> list[Lane]:
    """A lane for each part of the program with its modes one after the other; modes that run at the same time have
    lanes of their own.
    """
    found: list[Lane] = []
    for group in groups:
        if not group.modes:
            continue
        bars = {path: list(_bars(run, group, path)) for path in group.modes}
        if _overlap([bar for own in bars.values() for bar in own]):
            found += [
                Lane(group.modes[path], [replaced(bar, text="", color=RUNNING) for bar in own])
                for path, own in bars.items()
            ]
        elif any(bars.values()):
            ordered = sorted(bar for own in bars.values() for bar in own)
            found.append(
                Lane(
                    group.name,
                    [replaced(bar, text="", color=RUNNING) if bar.text == group.name else bar for bar in ordered],
                )
            )
    return found[:_MOST_LANES]


def process_lanes(run: RunData) -> list[Lane]:
    """A lane for each process, for a program with nothing else to show."""
    paths = list(dict.fromkeys(activity.path for activity in run.activities))[:_MOST_LANES]
    return [Lane(path, [Bar(*_span(run, a.start, a.end)) for a in run.activities if a.path == path]) for path in paths]


def one_after_the_other(run: RunData, group: ModeGroup) -> list[Bar]:
    """The modes of a group, if no two of them run at the same time; else nothing."""
    bars = sorted(bar for path in group.modes for bar in _bars(run, group, path))
    return [] if len(group.modes) < 2 or _overlap(bars) else bars


def _bars(run: RunData, group: ModeGroup, path: str) -> Iterator[Bar]:
    color = MODE_COLORS[list(group.modes).index(path) % len(MODE_COLORS)]
    for activity in run.activities:
        if activity.path == path:
            yield Bar(*_span(run, activity.start, activity.end), group.modes[path], color)


def _span(run: RunData, start: int, end: int | None) -> tuple[float, float]:
    return start / 1e9, (run.outcome.time if end is None else end) / 1e9


def _overlap(bars: Sequence[Bar]) -> bool:
    ordered = sorted(bars)
    return any(one.end > other.start + 1e-12 for one, other in pairwise(ordered))


_MOST_LETTERS = 90
"""The number of values that a lane has room for; numbers that change more often are a curve, not events."""


def are_events(series: Series) -> bool:
    """Whether the values are whole numbers that change so seldom that all of them can be written."""
    from cspdiag.model.types import IntType

    if not (series.is_event and isinstance(series.type, IntType)):
        return False
    return sum(len(str(series.value[position])) + 2 for position in series.written) <= _MOST_LETTERS


def series_lane(run: RunData, series: Series) -> Lane:
    """The lane of truth values, literals or events."""
    end = end_of(run)
    arrivals = apart(series, end).time.tolist() if series.is_event else []
    if isinstance(series.type, BoolType):
        return Lane(series.name, truth=series, arrivals=arrivals)
    if not isinstance(series.type, EnumType):
        events = [Event(float(series.time[at]), str(series.value[at])) for at in series.written]
        return Lane(series.name, events=events, arrivals=arrivals)
    changes = series.changes.tolist()
    instants = [float(series.time[position]) for position in changes]
    ends = [*instants[1:], end]
    literals = series.type.literals
    bars = [
        Bar(
            start,
            stop,
            literals[int(series.value[at])],
            LITERAL_COLORS[int(series.value[at]) % 6],
            bool(series.unread[at]),
        )
        for at, start, stop in zip(changes, instants, ends, strict=True)
    ]
    return Lane(series.name, bars, arrivals=arrivals)


_SEVERAL = "several, briefly"
_SEVERAL_COLOR = "#555555"
"""The colour of bars that are too narrow to be distinguished."""


def draw_lanes(axes: Axes, lanes: Sequence[Lane], end: float, inches: float) -> None:
    """Draw lanes below each other; ``inches`` is the approximate width of the axes, which decides which texts have
    room.
    """
    axes.set_ylim(len(lanes), 0)
    axes.set_yticks([row + 0.5 for row in range(len(lanes))], [shortened(lane.name) for lane in lanes], fontsize=7.5)
    axes.tick_params(axis="y", length=0, pad=6)
    for side in ("left", "bottom"):
        axes.spines[side].set_visible(False)
    letter = end / inches * 0.056
    """The width of a letter on the axis of time."""
    unnamed: dict[tuple[str, str], str] = {}
    for row, lane in enumerate(lanes):
        axes.axhline(row, color="#dddddd", linewidth=0.4, zorder=0)
        sort = lane.name.partition("[")[0]
        colors = _draw_bars(axes, row, _joined(lane.bars, end), letter, end * _NARROW)
        unnamed.update({(sort, name): color for name, color in colors.items()})
        if lane.truth is not None:
            _draw_truth(axes, row, lane.truth, end)
        if not lane.bars and not lane.events and (lane.truth is None or not len(lane.truth.time)):
            axes.text(letter, row + 0.52, "no value", va="center", fontsize=7, color=FAINT, style="italic")
        _draw_events(axes, row, lane, end, letter)
    if unnamed:
        _legend(axes, unnamed)


def _draw_bars(axes: Axes, row: int, bars: Sequence[Bar], letter: float, least: float) -> dict[str, str]:
    """Draw bars, none narrower than ``least``, and return the colours of those that have no room for their names, by
    name.
    """
    from matplotlib.patches import Rectangle

    shown = set()
    for bar in bars:
        axes.add_patch(
            Rectangle(
                (bar.start, row + _HIGH), max(bar.end - bar.start, least), _LOW - _HIGH,
                facecolor="none" if bar.thin else bar.color,
                edgecolor=INK, linewidth=0.3 if bar.thin else 0.7, zorder=1.5 if bar.end - bar.start < least else 1,
            )
        )  # fmt: skip
        if bar.text and (len(bar.text) + 0.7) * letter <= bar.end - bar.start:
            shown.add(bar.text)
            axes.text(
                (bar.start + bar.end) / 2, row + 0.52, bar.text, ha="center", va="center", fontsize=7, color="#222222"
            )
    return {bar.text: bar.color for bar in bars if bar.text and bar.text not in shown}


def _joined(bars: Sequence[Bar], end: float) -> list[Bar]:
    """Bars that are too narrow to be distinguished, as one."""
    joined: list[Bar] = []
    for bar in bars:
        last = joined[-1] if joined else None
        if last is not None and max(bar.end - last.start, 0) < end * _NARROW and bar.start - last.end < end * _NARROW:
            text = bar.text if bar.text == last.text else _SEVERAL
            joined[-1] = Bar(last.start, bar.end, text, _SEVERAL_COLOR)
        else:
            joined.append(bar)
    return joined


def _draw_truth(axes: Axes, row: int, series: Series, end: float) -> None:
    def height(values: object) -> object:
        return row + _LOW + (_HIGH - _LOW) * values  # type: ignore[operator]

    changed = series.changes
    few = replaced(series, time=series.time[changed], value=series.value[changed], unread=series.unread[changed])
    if not len(few.time):
        return
    for unread in {bool(value) for value in few.unread}:
        time, value = stairs(few, end, unread=unread)
        axes.plot(time, height(value), color=INK, linewidth=0.4 if unread else 1.1, solid_joinstyle="miter")  # type: ignore[arg-type]
        if not unread:
            axes.fill_between(time, row + _LOW, height(value), color=MODE_COLORS[0], linewidth=0)  # type: ignore[arg-type]


def _draw_events(axes: Axes, row: int, lane: Lane, end: float, letter: float) -> None:
    """Draw diamonds with the values of the events next to them; strokes below that if they are close together, and
    below levels.
    """
    is_dense = any(second - first < 3 * letter for first, second in pairwise(lane.arrivals))
    is_wide = bool(lane.events) and not is_dense
    below = row + (0.52 if is_wide else _LOW - 0.06)
    marker: dict[str, Any] = {"marker": "|", "markersize": 5, "markeredgewidth": 0.6, "zorder": 3}
    if is_wide:
        marker = {"marker": "d", "markersize": 4}
    if lane.arrivals:  # an empty line that is not clipped would stretch the layout
        axes.plot(lane.arrivals, [below] * len(lane.arrivals), linestyle="", color=INK, clip_on=False, **marker)
    marks = lane.arrivals if is_wide else [event.instant for event in lane.events]
    for label in labels_of(lane.events, marks, end, letter, gap=letter if is_wide else 0.0):
        height = row + (0.52 if is_wide else 0.4)
        side = "right" if label.is_left else "left"
        axes.text(label.place, height, label.text, ha=side, va="center", fontsize=7, color="#222222")


def _legend(axes: Axes, names: dict[tuple[str, str], str]) -> None:
    """Draw the legend of the colours, with the name of the port if one colour means several values."""
    from matplotlib.patches import Patch

    words, pairs = {name for _, name in names}, {(name, color) for (_, name), color in names.items()}
    several = not len(words) == len(set(names.values())) == len(pairs)
    labels = {f"{sort}: {name}" if several else name: color for (sort, name), color in names.items()}
    patches = [Patch(facecolor=color, edgecolor=INK, linewidth=0.5, label=name) for name, color in labels.items()]
    axes.legend(handles=patches[:20], loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0)
