"""One hyperperiod as a Gantt chart in SVG: a row for each thread and one for the kernel, a bar for each step, an arrow
for each release.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count
from math import lcm
from xml.sax.saxutils import escape

from cspdiag.analyses.timing.report.render_text import time
from cspdiag.analyses.timing.result import TimingReport
from cspdiag.analyses.timing.task import ONCE, Task
from cspdiag.analyses.timing.tasks.schedule import Schedule, simulate
from cspdiag.base.record import record, replaced

_LEAST_WIDTH, _LEAST_CHART, _LARGEST_CHART = 900, 700, 3900
_ROW, _TOP, _MARGIN = 34, 58, 24
_SPACE = 16
"""Between two releases of the most frequent task that can be drawn, in pixels, unless the picture becomes too wide."""
_ARROW, _STROKE = 8.0, 3.0
"""The distances of releases that still show each as an arrow, and as a stroke."""
_LEAST_BAR = 1.6
"""The width of what takes next to no time; bars that are closer than this are one."""
_EDGED = 4.0
"""Narrower bars have no edge, of which there would be little left."""
_COLOURS = ("#1b6ca8", "#d1721c", "#3a8f4d", "#8e5aa8", "#4b4f97", "#5b7083", "#a38a1f", "#2a9d9d")
_LATE = "#c00000"
_LARGEST_NUMBER_OF_BARS = 4000
_LONGEST_NAME = 48


@record
class _Bar:
    """Steps of one task that are drawn as one: their number, and the release of the first."""

    start: int
    end: int
    release: int
    is_late: bool
    steps: int = 1


def gantt_svg(report: TimingReport) -> str:
    """The chart of all recurring work, with all periods beginning together and every job taking its longest time.

    If a hyperperiod has more steps than can be distinguished, only its beginning is shown. The kernel's work is that at
    ticks: ends of delays and time-outs are too rare to be drawn with them.
    """
    tasks = [task for task in report.tasks if task.period < ONCE and task.work]
    if not tasks:
        return _document(_LEAST_WIDTH, 120, ['<text x="24" y="60" class="name">nothing recurs that takes time</text>'])
    tasks.sort(key=lambda task: (task.priority, task.period))
    rows = [*([report.kernel_ticks] if report.kernel_ticks else []), *((task,) for task in tasks)]
    tasks = [task for row in rows for task in row]
    limit = None
    hyperperiod = lcm(*(task.period for task in tasks))
    steps = sum(max(1, -(-task.work // task.step)) * (hyperperiod // task.period) for task in tasks)
    if steps > _LARGEST_NUMBER_OF_BARS:
        limit = max(task.period for task in tasks)
    schedule = simulate(tasks, limit=limit)
    left = _MARGIN + round(max(_text_width(_shown(_row_name(row)), 12) for row in rows)) + 14
    releases = [schedule.length // task.period for task in tasks]
    most = max((count for count in releases if count * _STROKE <= _LARGEST_CHART), default=0)
    chart = min(max(_LEAST_CHART, _SPACE * most), _LARGEST_CHART)
    title = _title(report, schedule)
    width = max(_LEAST_WIDTH, left + chart + _MARGIN, 2 * _MARGIN + round(_text_width(title, 14)))
    height = _TOP + len(rows) * _ROW + 44
    return _document(width, height, list(_chart(title, rows, schedule, left, width)))


def _title(report: TimingReport, schedule: Schedule) -> str:
    what = "one hyperperiod" if schedule.is_whole else f"the first {time(schedule.length)} of a hyperperiod"
    return f"{report.process}: {what} of {time(schedule.hyperperiod)}, every step at its longest"


def _chart(title: str, rows: Sequence[Sequence[Task]], schedule: Schedule, left: int, width: int) -> Iterator[str]:
    right = width - _MARGIN
    scale = (right - left) / schedule.length
    bottom = _TOP + len(rows) * _ROW
    yield f'<text x="{_MARGIN}" y="26" class="title">{escape(title)}</text>'
    for instant in _ticks(schedule.length, max(7, (right - left) // 90)):
        x = left + instant * scale
        yield f'<line x1="{x:.2f}" y1="{_TOP - 8}" x2="{x:.2f}" y2="{bottom}" class="grid"/>'
        yield f'<text x="{x:.2f}" y="{bottom + 18}" class="tick">{time(instant)}</text>'
    notes = ["arrows: releases; within a priority level first come, first served"]
    numbers = count()
    for row, tasks in enumerate(rows):
        y = _TOP + row * _ROW
        yield f'<text x="{_MARGIN}" y="{y + 19}" class="name">{_titled(_row_name(tasks))}</text>'
        yield f'<line x1="{left}" y1="{y + 26}" x2="{right}" y2="{y + 26}" class="base"/>'
        if any(task.period * scale < _STROKE for task in tasks):
            notes.append("grey bands: releases that are too many to be drawn")
            yield f'<rect x="{left}" y="{y + 26}" width="{right - left}" height="3" class="many"/>'
        for task in tasks:
            if task.period * scale >= _STROKE:
                yield from _releases(task, schedule.length, left, y + 26, scale)
            for bar in sorted(_bars(schedule, next(numbers), task, scale), key=lambda bar: bar.is_late):
                if bar.is_late:
                    notes.append("red and taller: ends after the next release")
                yield _drawn(bar, task, _COLOURS[row % len(_COLOURS)], left, y, scale)
    yield f'<text x="{_MARGIN}" y="{bottom + 38}" class="note">{"; ".join(dict.fromkeys(notes))}</text>'


def _releases(task: Task, length: int, left: int, base: int, scale: float) -> Iterator[str]:
    head = " m-3 5 l3 -5 l3 5" if task.period * scale >= _ARROW else ""
    for k in range(length // task.period + 1):
        yield f'<path d="M{left + k * task.period * scale:.2f} {base} v-24{head}" class="release"/>'


def _bars(schedule: Schedule, number: int, task: Task, scale: float) -> list[_Bar]:
    """What a task runs, where steps that could not be distinguished are one."""
    bars: list[_Bar] = []
    for part in schedule.slices:
        if part.task != number or part.start >= schedule.length:
            continue
        is_late = part.is_last and part.end - part.release > task.deadline
        bar = _Bar(part.start, min(part.end, schedule.length), part.release, is_late)
        last = bars[-1] if bars else None
        is_near = last is not None and (bar.start - last.start) * scale < _LEAST_BAR
        if last is not None and is_near and last.is_late == is_late:
            bars[-1] = replaced(last, end=bar.end, steps=last.steps + 1)
        else:
            bars.append(bar)
    return bars


def _drawn(bar: _Bar, task: Task, colour: str, left: int, y: int, scale: float) -> str:
    tip = f"{_name(task)}: {time(bar.start)} to {time(bar.end)}, released at {time(bar.release)}"
    tip += f" and later, {bar.steps} steps" if bar.steps > 1 else ""
    tip += ", late" if bar.is_late else ""
    length = (bar.end - bar.start) * scale
    edge = ' class="edged"' if length >= _EDGED else ""
    top, height = (y + 2, 24) if bar.is_late else (y + 8, 18)
    return (
        f'<rect x="{left + bar.start * scale:.2f}" y="{top}" width="{max(_LEAST_BAR, length):.2f}" height="{height}" '
        f'fill="{_LATE if bar.is_late else colour}"{edge}><title>{escape(tip)}</title></rect>'
    )


def _ticks(length: int, most: int) -> Iterator[int]:
    """Round instants, up to a limit."""
    step = 1
    while length / step > most:
        step = next(step * factor for factor in (2, 5, 10) if length / (step * factor) <= most or factor == 10)
    yield from range(0, length + 1, step)


def _name(task: Task) -> str:
    path = task.name.partition(".")[2] or task.name
    return f"{path} @ {time(task.period)}"


def _row_name(tasks: Sequence[Task]) -> str:
    """The name of a row; the work of the kernel may have several periods."""
    return _name(tasks[0]) if len(tasks) == 1 else tasks[0].name


def _shown(name: str) -> str:
    """The name, cut in the middle where it would take the room of the chart."""
    if len(name) <= _LONGEST_NAME:
        return name
    half = _LONGEST_NAME // 2
    return f"{name[: half - 1]}…{name[-half:]}"


def _titled(whole: str) -> str:
    shown = _shown(whole)
    return escape(shown) if shown == whole else f"{escape(shown)}<title>{escape(whole)}</title>"


def _text_width(text: str, size: float) -> float:
    """At least what a text takes in the typefaces that viewers use."""
    return size * sum(0.98 if letter in "mwMW@%…" else 0.78 if letter.isupper() else 0.6 for letter in text)


def _document(width: int, height: int, parts: list[str]) -> str:
    style = (
        "text{font-family:sans-serif;fill:#222}.title{font-size:14px;font-weight:600}.name{font-size:12px}"
        ".tick{font-size:11px;text-anchor:middle}.note{font-size:11px;fill:#666}.grid{stroke:#ddd}.base{stroke:#888}"
        ".release{fill:none;stroke:#888}.many{fill:#888}.edged{stroke:white;stroke-width:.5}"
    )
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}">'
    return (
        "\n".join(
            [head, f"<style>{style}</style>", '<rect width="100%" height="100%" fill="white"/>', *parts, "</svg>"]
        )
        + "\n"
    )
