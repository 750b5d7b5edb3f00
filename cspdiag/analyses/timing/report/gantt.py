"""One hyperperiod as a Gantt chart in SVG: a row for each thread, a bar for each step, an arrow for each release."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from xml.sax.saxutils import escape

from cspdiag.analyses.timing.report.render_text import time
from cspdiag.analyses.timing.result import TimingReport
from cspdiag.analyses.timing.task import ONCE, Task
from cspdiag.analyses.timing.tasks.schedule import Schedule, simulate

_LEAST_WIDTH, _LARGEST_WIDTH, _ROW, _TOP, _MARGIN = 900, 4000, 34, 58, 24
_SPACE = 16
"""Between two releases of the most frequent task, in pixels, unless the picture becomes too wide."""
_COLOURS = ("#1b6ca8", "#d1721c", "#3a8f4d", "#8e5aa8", "#b5443c", "#5b7083", "#a38a1f", "#2a9d9d")
_LARGEST_NUMBER_OF_BARS = 4000


def gantt_svg(report: TimingReport) -> str:
    """The chart of all recurring work, with all periods beginning together and every job taking its longest time.

    If a hyperperiod has more steps than can be distinguished, only its beginning is shown.
    """
    tasks = [task for task in report.tasks if task.period < ONCE and task.work]
    if not tasks:
        return _document(_LEAST_WIDTH, 120, ['<text x="24" y="60" class="name">nothing recurs that takes time</text>'])
    tasks.sort(key=lambda task: (task.priority, task.period))
    limit = None
    steps = sum(max(1, -(-task.work // task.step)) * (report.hyperperiod // task.period) for task in tasks)
    if steps > _LARGEST_NUMBER_OF_BARS:
        limit = max(task.period for task in tasks)
    schedule = simulate(tasks, limit=limit)
    left = _MARGIN + max(len(_name(task)) for task in tasks) * 7.2 + 14
    height = _TOP + len(tasks) * _ROW + 44
    releases = schedule.length // min(task.period for task in tasks)
    width = min(max(_LEAST_WIDTH, round(left) + _MARGIN + _SPACE * releases), _LARGEST_WIDTH)
    return _document(width, height, list(_chart(report, tasks, schedule, left, width)))


def _chart(report: TimingReport, tasks: Sequence[Task], schedule: Schedule, left: float, width: int) -> Iterator[str]:
    right = width - _MARGIN
    scale = (right - left) / schedule.length
    bottom = _TOP + len(tasks) * _ROW
    what = "one hyperperiod" if schedule.is_whole else f"the first {time(schedule.length)} of a hyperperiod"
    yield (
        f'<text x="{_MARGIN}" y="26" class="title">{escape(report.process)}: {what} of {time(schedule.hyperperiod)}, '
        "every step at its longest</text>"
    )
    for instant in _ticks(schedule.length, max(10, width // 90)):
        x = left + instant * scale
        yield f'<line x1="{x:.2f}" y1="{_TOP - 8}" x2="{x:.2f}" y2="{bottom}" class="grid"/>'
        yield f'<text x="{x:.2f}" y="{bottom + 18}" class="tick">{time(instant)}</text>'
    for row, task in enumerate(tasks):
        y = _TOP + row * _ROW
        yield f'<text x="{_MARGIN}" y="{y + 19}" class="name">{escape(_name(task))}</text>'
        yield f'<line x1="{left}" y1="{y + 26}" x2="{right}" y2="{y + 26}" class="base"/>'
        for k in range(schedule.length // task.period + 1):
            x = left + k * task.period * scale
            yield f'<path d="M{x:.2f} {y + 26} v-24 m-3 5 l3 -5 l3 5" class="release"/>'
    is_late = False
    for part in schedule.slices:
        if part.start >= schedule.length:
            continue
        task = tasks[part.task]
        late = part.is_last and part.end - part.release > task.deadline
        is_late |= late
        length = max(0.6, (min(part.end, schedule.length) - part.start) * scale)
        colour = "#c00000" if late else _COLOURS[part.task % len(_COLOURS)]
        tip = (
            f"{_name(task)}: {time(part.start)} to {time(part.end)}, released at "
            f"{time(part.release)}{', late' if late else ''}"
        )
        yield (
            f'<rect x="{left + part.start * scale:.2f}" y="{_TOP + part.task * _ROW + 8}" width="{length:.2f}" '
            f'height="18" fill="{colour}">'
            f"<title>{escape(tip)}</title></rect>"
        )
    note = "arrows: releases; within a priority level first come, first served"
    note += "; red: ends after the next release" if is_late else ""
    yield f'<text x="{_MARGIN}" y="{bottom + 38}" class="note">{note}</text>'


def _ticks(length: int, most: int) -> Iterator[int]:
    """Round instants, up to a limit."""
    step = 1
    while length / step > most:
        step = next(step * factor for factor in (2, 5, 10) if length / (step * factor) <= most or factor == 10)
    yield from range(0, length + 1, step)


def _name(task: Task) -> str:
    path = task.name.partition(".")[2] or task.name
    return f"{path} @ {time(task.period)}"


def _document(width: int, height: int, parts: list[str]) -> str:
    style = (
        "text{font-family:sans-serif;fill:#222}.title{font-size:14px;font-weight:600}.name{font-size:12px}"
        ".tick{font-size:11px;text-anchor:middle}.note{font-size:11px;fill:#666}.grid{stroke:#ddd}.base{stroke:#888}"
        ".release{fill:none;stroke:#888}rect{stroke:white;stroke-width:.5}"
    )
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}">'
    return (
        "\n".join(
            [head, f"<style>{style}</style>", '<rect width="100%" height="100%" fill="white"/>', *parts, "</svg>"]
        )
        + "\n"
    )
