"""``cspdiag verify --timing``: response times, latencies and the schedule of the sampled loops."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, cast

from cspdiag.cli.failure import FINE, UNSUCCESSFUL, UsageError
from cspdiag.cli.output import replace_text
from cspdiag.cli.terminal import show_diagnostics
from cspdiag.sources import read_source

if TYPE_CHECKING:
    from cspdiag.analyses.timing.measured import Measured
    from cspdiag.analyses.timing.result import TimingReport


def run_timing(arguments: Namespace) -> int:
    """Analyse the program, print the table or JSON, draw the schedule; fine where every deadline is proved to be met."""
    if arguments.format not in ("text", "json"):
        raise UsageError(f"--timing has no format {arguments.format}: it is text or json")
    gantt = arguments.gantt
    if gantt is not None and (gantt.suffix != ".svg" or gantt.is_dir() or not gantt.parent.is_dir()):
        raise UsageError(f"--gantt {gantt}: the name of an .svg file in a folder that exists is wanted")
    measured = [] if arguments.wcet_from is None else measured_times(str(arguments.wcet_from))
    report = _report(arguments, measured)
    if report is None:
        return UNSUCCESSFUL
    if gantt is not None:
        from cspdiag.analyses.timing.gantt import gantt_svg

        replace_text(str(gantt), gantt_svg(report))
    if arguments.format == "json":
        from cspdiag.analyses.timing.render_json import render

        sys.stdout.write(render(report))
    elif not (arguments.quiet and report.is_schedulable):
        from cspdiag.analyses.timing.render_text import table

        sys.stdout.write(table(report))
    return FINE if report.is_schedulable else UNSUCCESSFUL


def _report(arguments: Namespace, measured: Sequence[Measured]) -> TimingReport | None:
    from cspdiag import pipeline
    from cspdiag.analyses.timing.report import timing_report
    from cspdiag.network.lower import SelectionError
    from cspdiag.settings import SettingError, split_setting

    try:
        settings = dict(split_setting(setting) for setting in arguments.set)
        built = pipeline.build(read_source(arguments.file), read_source, top=arguments.process, settings=settings)
    except (SettingError, SelectionError) as problem:
        raise UsageError(str(problem)) from None
    show_diagnostics(built.checked.report.diagnostics, arguments.color)
    if built.network is None:
        return None
    from cspdiag.analyses.timing.measured import times_of_laws

    report = timing_report(built.network, times_of_laws(built.network, measured))
    if measured and not report.measured:
        raise UsageError(
            f"--wcet-from {arguments.wcet_from}: none of its names is a law or process of {built.network.top}"
        )
    return report


def measured_times(path: str) -> list[Measured]:
    """The longest execution times in a trace.

    A trace is what ``run --real-time --trace out.json`` writes, or any JSON object with ``executionTimes``: an object from paths to times in seconds,
    or to objects with ``longest``, and ``what`` was measured. Raises UsageError where there are none, OSError where the file cannot be read.
    """
    from cspdiag.analyses.timing.measured import Measured

    try:
        with open(path, encoding="utf-8") as file:
            content = json.load(file)
    except ValueError as problem:
        raise UsageError(f"{path}: is no JSON ({problem})") from None
    times = content.get("executionTimes") if isinstance(content, dict) else None
    if not isinstance(times, dict) or not times:
        raise UsageError(
            f"{path}: has no execution times: write it with cspdiag run --real-time --target c --trace {path}, or with -O0"
        )
    found: list[Measured] = []
    for name, entry in times.items():
        seconds, what = (entry.get("longest"), entry.get("what")) if isinstance(entry, dict) else (entry, "law")
        if isinstance(seconds, bool) or not isinstance(seconds, int | float) or not 0 <= seconds < 1e9:
            raise UsageError(f"{path}: the execution time of {name} is no number of seconds")
        if what not in ("law", "process", "thread"):
            raise UsageError(f"{path}: what was measured of {name} is a law, a process or a thread, not {what!r}")
        found.append(
            Measured(name, max(1, -(-round(seconds * 1e10) // 10)), cast("Literal['law', 'process', 'thread']", what))
        )
    return found
